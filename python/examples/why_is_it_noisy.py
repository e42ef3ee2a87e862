#!/usr/bin/env python3
"""Renders a small scene made of numpy arrays and shows why its pixels differ: the image, the samples
that each pixel got, the bandwidth that was predicted for it, and its filter as an ellipse.

Run it in pieces in a notebook (# %% marks the cells), or as a script:

    PYTHONPATH=build/release/python python3 python/examples/why_is_it_noisy.py -o out

With matplotlib (Debian: python3-matplotlib) it draws one figure, without it one PNG per map.
"""

# %% The scene: a checkered floor, a row of balls out of focus, one of them moving.
import argparse
import pathlib

import numpy

import covtrace


def build(resolution):
    scene = covtrace.SceneBuilder()
    scene.camera(eye=(0, 1.4, 5), target=(0, 0.5, 0), fov=35, resolution=resolution,
                 lensradius=0.12, focaldistance=4.2)
    scene.integrator(max_depth=6, spp=16)
    even = (numpy.indices((256, 256)).sum(0) // 16) % 2
    scene.texture("checks", numpy.where(even[:, :, None] == 1, (0.8, 0.8, 0.75), (0.1, 0.12, 0.15)))
    scene.material("floor", "diffuse", **{"texture reflectance": "checks"})
    scene.mesh([[-6, 0, -6], [6, 0, -6], [6, 0, 6], [-6, 0, 6]], numpy.array([[0, 2, 1], [0, 3, 2]]),
               uv=[[0, 0], [3, 0], [3, 3], [0, 3]], material="floor")
    for i, x in enumerate((-1.4, 0.0, 1.4)):
        name = f"ball {i}"
        scene.material(name, "coateddiffuse", reflectance=((0.7, 0.15, 0.1), (0.1, 0.4, 0.7),
                                                           (0.8, 0.6, 0.1))[i], roughness=0.02)
        start, end = numpy.eye(4), numpy.eye(4)
        start[:3, 3] = end[:3, 3] = (x, 0.5, 1.2 * (i - 1))
        end[0, 3] += 0.4 * (i == 2)
        scene.shape("sphere", material=name, transform=start, end_transform=end, radius=0.5)
    scene.mesh([[-1, 3.5, -1], [1, 3.5, -1], [1, 3.5, 1], [-1, 3.5, 1]],
               numpy.array([[0, 1, 2], [0, 2, 3]]), emission=(8, 7.5, 7))
    scene.light("infinite", L=(0.3, 0.4, 0.55))
    return scene


# %% What is drawn: maps with their names.
def maps(image):
    """name -> (height, width) map."""
    sizes = numpy.linalg.eigvalsh(image.matrices("filter"))
    spectrum = numpy.trace(image.matrices("spectrum"), axis1=2, axis2=3)
    return {
        "samples per pixel": image["samples"],
        "estimated error / value": image["error"] / (image.rgb.mean(axis=2) + 0.01),
        "bandwidth, log10 cycles per pixel": 0.5 * numpy.log10(numpy.maximum(spectrum, 1e-8)),
        "filter's long axis, pixels": numpy.sqrt(numpy.maximum(sizes[..., 1], 0)),
    }


def scaled(values):
    low, high = numpy.nanpercentile(values, [1, 99])
    return numpy.clip((values - low) / max(high - low, 1e-12), 0, 1)


def write_pictures(image, folder):
    """Writes one grey picture per map, where there is no matplotlib."""
    image.write(folder / "image.png")
    for name, values in maps(image).items():
        grey = numpy.repeat(scaled(values)[:, :, None], 3, axis=2)
        covtrace.Image.from_arrays(grey).write(folder / f"{name.split(',')[0].replace(' / ', ' by ')}.png")


def draw_figure(image, folder):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.patches import Ellipse

    figure, axes = pyplot.subplots(3, 2, figsize=(12, 10), layout="constrained")
    shown = numpy.clip(image.rgb, 0, 1) ** (1 / 2.2)
    axes[0, 0].imshow(shown)
    axes[0, 0].set_title("image")
    axes[0, 1].imshow(0.4 * shown)
    axes[0, 1].set_title("filters, one standard deviation")
    matrices = image.matrices("filter")
    step = max(4, image.size[0] // 32)
    for y in range(step // 2, image.size[1], step):
        for x in range(step // 2, image.size[0], step):
            (low, high), vectors = numpy.linalg.eigh(matrices[y, x])
            angle = numpy.degrees(numpy.arctan2(vectors[1, 1], vectors[0, 1]))
            axes[0, 1].add_patch(Ellipse((x, y), 2 * high**0.5, 2 * max(low, 0)**0.5, angle=angle,
                                         fill=False, color="orange", linewidth=0.6))
    for axis, (name, values) in zip(axes.flat[2:], maps(image).items()):
        picture = axis.imshow(values, cmap="viridis", vmin=numpy.nanpercentile(values, 1),
                              vmax=numpy.nanpercentile(values, 99))
        axis.set_title(name)
        figure.colorbar(picture, ax=axis)
    figure.savefig(folder / "why_is_it_noisy.png", dpi=110)


# %% Render, print, draw.
def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", default="out", help="folder for the pictures")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--spp", type=float, default=16)
    arguments = parser.parse_args()
    folder = pathlib.Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)

    resolution = tuple(int(n) for n in arguments.size.split("x"))
    image = covtrace.render(build(resolution), spp=arguments.spp)
    y, x = numpy.unravel_index(numpy.argmax(image["samples"]), image["samples"].shape)
    sigma = image.matrices("cov")[y, x].astype(float)
    print(f"most samples: {image['samples'][y, x]:.0f} at pixel {x},{y}; there lens and shutter ask for "
          f"{covtrace.covariance.integration_count(sigma):.1f}, the image's own detail is "
          f"{covtrace.covariance.image_density(covtrace.covariance.preintegrate(sigma)):.3g} cycles^2 per pixel^2")
    try:
        draw_figure(image, folder)
    except ImportError:
        write_pictures(image, folder)
    print(f"pictures are in {folder}")


if __name__ == "__main__":
    main()
