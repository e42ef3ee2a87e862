"""--camera: a perspective pinhole in place of whatever camera the scene has."""

import re
import unittest

import exr
from support import DONE, USAGE, CliTest

# A red ball on the left of a green one, seen from +z with y up; blue is far above.
WORLD = """\
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [1 0 0]
  Translate -1 0 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [0 1 0]
  Translate 1 0 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [0 0 1]
  Translate 0 3 0
  Shape "sphere" "float radius" 1
AttributeEnd
"""
FILM = 'Film "rgb" "integer xresolution" 32 "integer yresolution" 16\nSampler "zsobol" "integer pixelsamples" 4\n'
ELSEWHERE = "LookAt 50 0 0  60 0 0  0 1 0\n"
FRONT = "eye 0,0,8 target 0,0,0 fov 30"


class Camera(CliTest):
    def colours(self, camera, before=ELSEWHERE + 'Camera "perspective"\n', *arguments, options=()):
        scene = before + FILM + WORLD
        image = exr.read(self.rendered("--method", "uniform", "--camera", camera, *options, scene=scene))
        return image, {c: image.pixels[c] for c in "RGB"}

    def halves(self, camera, before=ELSEWHERE + 'Camera "perspective"\n', options=()):
        """Which colours are seen in the left and in the right half."""
        image, pixels = self.colours(camera, before, options=options)
        seen = ["", ""]
        for c, values in pixels.items():
            for right in (0, 1):
                if any(v > 0.9 for i, v in enumerate(values) if (i % image.width >= image.width // 2) == bool(right)):
                    seen[right] += c
        return tuple(seen)

    def test_it_looks_from_the_eye_to_the_target(self):
        # pbrt's world is left-handed: +x is on the left of who looks along -z with y up.
        self.assertEqual(self.halves(FRONT), ("G", "R"))
        self.assertEqual(self.halves("fov 30 target 0,0,0 eye 0,0,-8"), ("R", "G"))
        self.assertEqual(self.halves("eye 0,0,-8 target -1,0,0 fov 6"), ("R", "R"))

    def test_a_mirrored_world_stays_so(self):
        self.assertEqual(self.halves(FRONT, "Scale -1 1 1\n" + ELSEWHERE + 'Camera "perspective"\n'), ("R", "G"))

    def test_a_part_of_the_view_does_not_tell_of_all(self):
        dark = WORLD.replace("AreaLightSource", "# AreaLightSource") + 'LightSource "point"\n'
        corner = FILM.replace('"rgb"', '"rgb" "float cropwindow" [0 0.1 0.8 1]')
        for film, camera, tells in ((corner, ("--camera", FRONT), False), (FILM, (), True)):
            result = self.render(ELSEWHERE + 'Camera "perspective"\n' + film + dark, *camera)
            self.assertEqual("the camera sees nothing" in result.stderr, tells, result)

    def test_another_view_stands_upright_and_holds_all(self):
        rod = 'WorldBegin\nAreaLightSource "diffuse" "rgb L" [1 1 1]\nRotate 30 0 1 0\nScale 0.1 0.1 10\nShape "sphere"\n'
        for away, turned in (("LookAt 0 -9 0  0 -99 0  0 0 1", ()), (ELSEWHERE, ("--camera", "eye 0,-99,0 target 0,-999,0 fov 40 up 0,0,1"))):
            scene = f'{away}\nCamera "perspective"\n' + FILM + rod
            told = self.render(scene, *turned)
            image = exr.read(self.rendered("--method", "uniform", "--camera", re.search("--camera '(.*)'", told.stderr)[1], scene=scene))
            light = [i for i, v in enumerate(image.pixels["G"]) if v > 0.01]
            self.assertTrue(light)
            rows, columns = {i // image.width for i in light}, {i % image.width for i in light}
            self.assertTrue(min(rows) > 0 and max(rows) < 15 and min(columns) > 0 and max(columns) < 31, (rows, columns))
            self.assertGreater(len(rows), len(columns))

    def test_up(self):
        # Lying on its left side, the camera has the world's top on the right.
        self.assertEqual(self.halves("eye 0,0,-8 target 0,1.5,0 fov 40 up -1,0,0"), ("RG", "B"))
        z_up = "LookAt 50 0 0  60 0 0  0 0 1\nCamera \"perspective\"\n"
        self.assertEqual(self.halves("eye 8,0,0 target 0,1.5,0 fov 40", z_up), self.halves("eye 8,0,0 target 0,1.5,0 fov 40 up 0,0,1"))

    def test_any_kind_of_camera_is_replaced(self):
        plain = self.colours(FRONT)[1]
        for camera in (
            'Camera "orthographic" "float screenwindow" [-1 4 -2 7]',
            'Camera "perspective" "float screenwindow" [-0.1 0.4 -0.2 0.7] "float frameaspectratio" 3 "float lensradius" 2 "float focaldistance" 1',
            'Camera "spherical"',
            'Camera "realistic" "string lensfile" "missing.dat" "float aperturediameter" 20',
        ):
            with self.subTest(camera=camera):
                self.assertEqual(self.colours(FRONT, ELSEWHERE + camera + "\n")[1], plain)
        moving = "ActiveTransform EndTime\nTranslate 9 9 9\nActiveTransform All\n" + ELSEWHERE + 'Camera "perspective"\n'
        self.assertEqual(self.colours(FRONT, moving)[1], plain)

    def test_film_shutter_and_lens_options_hold(self):
        image, pixels = self.colours(FRONT)
        self.assertEqual((image.width, image.height), (32, 16))
        # The open lens is focused on the target, unless --focus says otherwise.
        self.assertEqual(self.halves(FRONT, options=["--fstop", "1"]), ("G", "R"))
        sharp = self.colours(FRONT, options=["--fstop", "0.01"])[1]
        self.assertEqual(sharp, self.colours(FRONT, options=["--fstop", "0.01", "--focus", "8"])[1])
        self.assertNotEqual(sharp, self.colours(FRONT, options=["--fstop", "0.01", "--focus", "2"])[1])
        self.assertNotEqual(sharp, pixels)

    def test_a_focus_of_closed_lenses_is_told(self):
        told = "--focus changes nothing: the camera's lens is closed"
        for lens, options, way_out in (
            ('"perspective"', (), " until --fstop opens it"),
            ('"orthographic"', (), ""),
            ('"perspective" "float lensradius" 1', (), None),
            ('"perspective"', ("--fstop", "2"), None),
            ('"perspective" "float lensradius" 1', ("--camera", FRONT), " until --fstop opens it"),
        ):
            result = self.render(ELSEWHERE + f"Camera {lens}\n" + FILM + WORLD, "--focus", "3", *options)
            self.assertEqual(result.code, DONE, result)
            expected = [] if way_out is None else [f"warning: {told}, and all is sharp{way_out}"]
            self.assertEqual([line for line in result.stderr.split("\n") if "focus" in line], expected, (lens, options))

    def test_an_f_number_needs_a_focal_length(self):
        """A field of view was made up for these; through an open lens a spherical camera showed something else."""
        for camera in ('Camera "orthographic"', 'Camera "spherical"'):
            scene = ELSEWHERE + camera + "\n" + FILM + WORLD
            self.assert_fails(self.render(scene, "--fstop", "2"), USAGE, "--fstop", "no focal length")
            self.assertEqual(self.render(scene, "--fstop", "2", "--camera", FRONT).code, DONE)

    def test_info_tells_the_kind(self):
        for camera, told in (
            ('"perspective" "float fov" 30', "perspective, field of view 30, lens radius 0"),
            ('"orthographic"', "orthographic, lens radius 0"),
            ('"spherical"', "spherical, equal-area, lens radius 0"),
            ('"spherical" "string mapping" "equirectangular"', "spherical, equirectangular, lens radius 0"),
            ('"spherical" "string mapping" "equirectangular" "float longitude" [90 180] "float latitude" [-45 90]',
             "spherical, equirectangular, longitude 90 to 180, latitude -45 to 90, lens radius 0"),
            ('"spherical" "string mapping" "equisolid" "float fov" 220', "equisolid fisheye, field of view 220, lens radius 0"),
            ('"orthographic" "float lensradius" 0.5 "integer apertureblades" 5 "float apertureratio" 2',
             "orthographic, lens radius 0.5, 5 blades, aperture ratio 2, focal"),
        ):
            self.write("scene.pbrt", f"{ELSEWHERE}Camera {camera}\n" + FILM + WORLD)
            self.assertIn(f"camera     {told}", self.run_program("info", "scene.pbrt").stdout)

    def test_films_know_it(self):
        scene = ELSEWHERE + 'Camera "perspective"\n' + FILM + WORLD
        arguments = ["--checkpoint", "a.film", "--spp", "2", "--camera", FRONT]
        self.assertEqual(self.render(scene, *arguments).code, DONE)
        self.assertEqual(self.render(scene, *arguments, "--resume").code, DONE)
        for other in (FRONT.replace("30", "31"), "eye 0,0,-8 target 0,0,0 fov 30"):
            self.assert_fails(self.render(scene, *arguments, "--resume", "--camera", other), USAGE, "--camera")
        self.assert_fails(self.render(scene, *arguments[:4], "--resume"), USAGE, "--camera", "the scene's")

    def test_what_a_view_lacks_is_told(self):
        for text, lacking in (("eye 0,0,8 target 0,0,0", "fov"), ("eye 0,0,8 fov 30", "target")):
            result = self.render(ELSEWHERE, "--camera", text)
            self.assertEqual(result.code, USAGE, result)
            self.assertIn(f"; '{lacking}' is missing", result.stderr)

    def test_errors(self):
        scene = ELSEWHERE + 'Camera "perspective"\n' + FILM + WORLD
        for wrong in (
            "front", "eye 0,0,8", "eye 0,0,8 target 0,0,0", "eye 0,0,8 target 0,0,0 fov", "eye 0,0,8 target 0,0,0 fov x",
            "eye 0,0 target 0,0,0 fov 30", "eye 0,0,8 target 0,0,0 fov 30 up 1", "eye 0,0,8 target 0,0,0 fov 30 roll 3",
            "eye 0,0,8 eye 0,0,8 target 0,0,0 fov 30", "eye nan,0,8 target 0,0,0 fov 30", "eye 0,0,inf target 0,0,0 fov 30",
            "eye 0, 0, 8 target 0,0,0 fov 30",
        ):
            self.assert_fails(self.render(scene, f"--camera={wrong}"), USAGE, "--camera", "eye 0,1,6")
        self.assert_fails(self.render(scene, "--camera="), USAGE, "--camera")
        for wrong in ("0", "-1", "180", "1e-9", "1e9"):
            self.assert_fails(self.render(scene, "--camera", f"eye 0,0,8 target 0,0,0 fov {wrong}"), USAGE, "--camera", "fov")
        for wrong in ("eye 1,2,3 target 1,2,3 fov 30", "eye 0,0,8 target 0,0,0 fov 30 up 0,0,1", "eye 0,0,8 target 0,0,0 fov 30 up 0,0,0",
                      "eye 3e38,0,0 target -3e38,0,0 fov 30"):
            self.assert_fails(self.render(scene, "--camera", wrong), USAGE, "--camera", "no direction of view")


if __name__ == "__main__":
    unittest.main()
