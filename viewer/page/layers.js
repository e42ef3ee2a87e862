// Layers of an image and their components that can be shown: colours, directions, single numbers, derived numbers.

import { axes, symmetricIndex } from './covariance.js';

const kSymmetric = ['xx', 'xy', 'yy'];

export const layerTitle = (layer) => (layer.name === '' ? 'image' : layer.name);

const hasChannels = (layer, names) => names.every((n) => layer.channels.some((c) => c.name === n));
const planesOf = (layer, names) => names.map((n) => layer.channels.find((c) => c.name === n).plane);

function scalar(id, label, planes, value) {
    return { id, label, kind: 'scalar', planes, value };
}

/** The components of a layer: { id, label, kind: colour | direction | scalar, planes, value(arrays, i) for scalars }. */
export function components(layer) {
    const list = [];
    if (hasChannels(layer, ['R', 'G', 'B'])) {
        const planes = planesOf(layer, ['R', 'G', 'B']);
        list.push({ id: 'colour', label: 'colour', kind: 'colour', planes });
        list.push(scalar('luminance', 'luminance', planes,
            ([r, g, b], i) => 0.2126 * r[i] + 0.7152 * g[i] + 0.0722 * b[i]));
    } else if (hasChannels(layer, ['X', 'Y', 'Z'])) {
        list.push({ id: 'direction', label: 'direction', kind: 'direction', planes: planesOf(layer, ['X', 'Y', 'Z']) });
    } else if (hasChannels(layer, kSymmetric)) {
        const unit = layer.name === 'filter' ? 'pixels' : 'cycles/pixel';
        list.push(scalar('width', `mean width, ${unit}`, planesOf(layer, kSymmetric),
            ([xx, xy, yy], i) => Math.sqrt(Math.sqrt(Math.max(0, xx[i] * yy[i] - xy[i] * xy[i])))));
    } else if (layer.name === 'cov' && layer.channels.length === 15) {
        const planes = layer.channels.map((c) => c.plane);
        axes.forEach((axis, k) => {
            const diagonal = planes[symmetricIndex(k, k)];
            list.push(scalar(`bandwidth-${k}`, `bandwidth ${axis.name}, ${axis.unit}`, [diagonal],
                ([d], i) => axis.scale * Math.sqrt(Math.max(0, d[i]))));
        });
    }
    for (const c of layer.channels) list.push(scalar(`channel-${c.name}`, c.name, [c.plane], ([v], i) => v[i]));
    return list;
}

export const findLayer = (image, name) => image.layers.find((l) => l.name === name);

/** Values of a layer's channels at a pixel; undefined where the layer is missing or not loaded yet. */
export function layerValues(planes, image, name, index) {
    const layer = findLayer(image, name);
    const values = layer && layer.channels.map((c) => planes.get(c.plane)).map((p) => p && p[index]);
    return values && values.every((v) => v !== undefined) ? values : undefined;
}
