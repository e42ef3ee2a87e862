// The state of the page: the report's images, and the choices of whoever looks at them.

import { differenceKinds } from './differences.js';
import { components, findLayer } from './layers.js';
import { Planes } from './planes.js';
import { Viewport } from './viewport.js';

export const byId = (id) => document.getElementById(id);
export const report = JSON.parse(byId('report').textContent);
export const planes = new Planes(report.planes, report.width * report.height);
export const images = report.images;
export const several = images.length > 1;
images.forEach((image, k) => { image.short = several ? `${'ABCDEFGH'[k] ?? k + 1} ${image.name}` : image.name; });
export const viewport = new Viewport(byId('view'), [report.width, report.height]);

export const state = {
    layout: several ? 'split' : 'a',
    a: 0,
    b: several ? 1 : 0,
    layer: '',
    component: 'colour',
    kind: 'absolute',
    exposure: 0,
    scale: 'false',
    range: null,  // null: automatic
    pixel: null,  // image coordinates, the data window's corner is (report.x0, report.y0)
};

export const layouts = several
    ? [['a', 'A'], ['b', 'B'], ['split', 'Split'], ['side', 'Side by side'], ['difference', 'Difference']]
    : [['a', 'Image']];

export const imageA = () => images[state.a];
export const imageB = () => images[state.b];
export const shownImages = () => (!several || state.layout === 'a' ? [imageA()] : state.layout === 'b' ? [imageB()] : [imageA(), imageB()]);

export function componentOf(image) {
    const layer = findLayer(image, state.layer);
    const list = layer ? components(layer) : [];
    return list.find((c) => c.id === state.component) ?? list[0];
}

export function layerNames() {
    const names = [];
    for (const image of [imageA(), imageB()])
        for (const layer of image.layers) if (!names.includes(layer.name)) names.push(layer.name);
    return names;
}

/** Maps are of the root layer, made when the report was. */
export const flipPlane = () => (state.layer === '' ? imageA().flip?.[state.b] ?? imageB().flip?.[state.a] : undefined);

export const possibleKinds = () => differenceKinds.filter((k) => k.id !== 'flip' || flipPlane() !== undefined);
export const currentKind = () => differenceKinds.find((k) => k.id === state.kind);
