// From the state to the pictures in the viewport.

import { divergingScale, greyScale, sequentialScale } from './color.js';
import { differenceMap } from './differences.js';
import { layerTitle } from './layers.js';
import { automaticRange, paintColour, paintDirection, paintScalar } from './raster.js';
import { byId, componentOf, currentKind, flipPlane, imageA, imageB, planes, report, shownImages, state, viewport } from './session.js';

function scalarValues(component) {
    const arrays = component.planes.map((p) => planes.get(p));
    if (component.id.startsWith('channel-')) return arrays[0];
    return Float32Array.from({ length: planes.count }, (_, i) => component.value(arrays, i));
}

let automatic = { low: 0, high: 1, log: false };
export const currentRange = () => state.range ?? automatic;

function newPicture() {
    const picture = document.createElement('canvas');
    picture.width = report.width;
    picture.height = report.height;
    const context = picture.getContext('2d');
    const data = context.createImageData(report.width, report.height);
    return { picture, data, finish: () => context.putImageData(data, 0, 0) };
}

/** The colours of a map; `symmetric`: around zero. */
export const scaleFor = (symmetric) => (state.scale === 'grey' ? greyScale : symmetric ? divergingScale : sequentialScale);

function paintValues(values, symmetric) {
    const target = newPicture();
    paintScalar(target.data.data, values, currentRange(), scaleFor(symmetric));
    target.finish();
    return target.picture;
}

function paintImage(image, values) {
    const component = componentOf(image);
    if (!component) return newPicture().picture;
    if (values) return paintValues(values, false);
    const target = newPicture();
    const arrays = component.planes.map((p) => planes.get(p));
    if (component.kind === 'colour') paintColour(target.data.data, arrays, 2 ** state.exposure);
    else paintDirection(target.data.data, arrays);
    target.finish();
    return target.picture;
}

function differenceValues() {
    if (state.kind === 'flip') return planes.get(flipPlane());
    const [a, b] = [componentOf(imageA()), componentOf(imageB())];
    if (!a || !b) return null;
    const arrays = (c) => (c.kind === 'scalar' ? [scalarValues(c)] : c.planes.map((p) => planes.get(p)));
    return differenceMap(state.kind, arrays(a), arrays(b));
}

const neededPlanes = () => {
    const list = shownImages().flatMap((image) => componentOf(image)?.planes ?? []);
    if (state.layout === 'difference' && state.kind === 'flip') list.push(flipPlane());
    return list;
};

let paintings = 0;
/** Paints; ends when the picture is there, or without one where the state has changed meanwhile. */
export async function paint() {
    const turn = ++paintings;
    await planes.load(neededPlanes());
    if (turn !== paintings) return;  // the state has changed meanwhile
    if (state.layout === 'difference') {
        const values = differenceValues();
        const kind = currentKind();
        automatic = state.kind === 'flip' ? { low: 0, high: 1, log: false } : values ? automaticRange(values, kind.symmetric) : automatic;
        const picture = values ? paintValues(values, kind.symmetric) : newPicture().picture;
        viewport.setPanes([{ picture, label: `${kind.label}, ${state.kind === 'flip' ? 'image' : layerTitle({ name: state.layer })}` }], 'one');
    } else {
        const shown = shownImages();
        const values = shown.map((image) => {
            const component = componentOf(image);
            return component?.kind === 'scalar' ? scalarValues(component) : null;
        });
        const measured = values.find(Boolean);
        if (measured) automatic = automaticRange(measured, false);
        viewport.setPanes(shown.map((image, k) => ({
            picture: paintImage(image, values[k]),
            label: componentOf(image) ? image.short : `${image.short}: no such layer`,
        })), state.layout === 'side' ? 'side' : 'split');
    }
    byId('view').dataset.painted = turn;
}
