// The controls above the picture show the state.

import { make } from './inspector.js';
import { components, findLayer, layerTitle } from './layers.js';
import { currentRange, scaleFor } from './painting.js';
import { byId, componentOf, currentKind, imageA, imageB, images, layerNames, possibleKinds, several, state } from './session.js';

export function fillSelect(select, options, value) {
    select.replaceChildren(...options.map(([id, label]) => make('option', { value: id }, label)));
    select.value = value;
}

function drawLegend(symmetric) {
    const legend = byId('legend'), context = legend.getContext('2d');
    const scale = scaleFor(symmetric);
    for (let x = 0; x < legend.width; ++x) {
        const c = 3 * Math.round((255 * x) / (legend.width - 1));
        context.fillStyle = `rgb(${scale[c]}, ${scale[c + 1]}, ${scale[c + 2]})`;
        context.fillRect(x, 0, 1, legend.height);
    }
}

export function showControls() {
    const difference = state.layout === 'difference';
    const component = componentOf(imageA()) ?? componentOf(imageB());
    const ranged = difference || component?.kind === 'scalar';
    for (const input of document.querySelectorAll('#layout-choices input')) input.checked = input.value === state.layout;
    fillSelect(byId('layer'), layerNames().map((n) => [n, layerTitle({ name: n })]), state.layer);
    const layer = findLayer(imageA(), state.layer) ?? findLayer(imageB(), state.layer);
    fillSelect(byId('component'), components(layer).map((c) => [c.id, c.label]), component.id);
    fillSelect(byId('kind'), possibleKinds().map((k) => [k.id, k.label]), state.kind);
    byId('image-a').value = state.a;
    byId('image-b').value = state.b;
    for (const label of document.querySelectorAll('.pair')) label.hidden = images.length < 3;
    byId('layouts').hidden = !several;
    byId('kind-label').hidden = !difference;
    byId('exposure-label').hidden = ranged || component?.kind !== 'colour';
    byId('range-controls').hidden = !ranged;
    byId('split-label').hidden = state.layout !== 'split';
    byId('exposure').value = state.exposure;
    byId('exposure-value').textContent = `${state.exposure > 0 ? '+' : ''}${state.exposure} EV`;
    byId('scale').value = state.scale;
    const range = currentRange();
    byId('low').value = Number(range.low.toPrecision(4));
    byId('high').value = Number(range.high.toPrecision(4));
    byId('logarithmic').checked = range.log;
    drawLegend(difference && currentKind().symmetric);
}
