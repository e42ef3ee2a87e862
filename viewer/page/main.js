// Starts the page: connects its controls, lists what never changes, paints.

import { change, fail, setSplit } from './actions.js';
import { fillSelect, showControls } from './controls.js';
import { make, makeTable } from './inspector.js';
import { keyTexts, onKey } from './keys.js';
import { findLayer } from './layers.js';
import { paint } from './painting.js';
import { pin, zoomTo } from './pixel.js';
import { listenToCanvas } from './pointer.js';
import { byId, imageA, images, layouts, report, several, state, viewport } from './session.js';

function listen() {
    document.addEventListener('keydown', onKey);
    listenToCanvas(byId('view'));
    for (const form of [byId('controls'), byId('pixel-form')]) form.addEventListener('submit', (e) => e.preventDefault());
    byId('layout-choices').addEventListener('change', (e) => change({ layout: e.target.value }));
    for (const name of ['layer', 'component', 'kind', 'scale'])
        byId(name).addEventListener('change', (e) => change({ [name]: e.target.value }));
    byId('image-a').addEventListener('change', (e) => change({ a: Number(e.target.value) }));
    byId('image-b').addEventListener('change', (e) => change({ b: Number(e.target.value) }));
    byId('exposure').addEventListener('input', (e) => change({ exposure: Number(e.target.value) }));
    byId('split').addEventListener('input', (e) => setSplit(Number(e.target.value) / 100));
    for (const name of ['low', 'high', 'logarithmic'])
        byId(name).addEventListener('change', () => change({
            range: { low: Number(byId('low').value), high: Number(byId('high').value), log: byId('logarithmic').checked },
        }));
    byId('automatic').addEventListener('click', () => change({ range: null }));
    byId('zoom-in').addEventListener('click', () => viewport.zoom(1.5));
    byId('zoom-out').addEventListener('click', () => viewport.zoom(1 / 1.5));
    byId('zoom-fit').addEventListener('click', () => viewport.fit());
    byId('zoom-actual').addEventListener('click', () => viewport.actualSize());
    byId('help-button').addEventListener('click', () => byId('help').showModal());
    byId('pixel-form').addEventListener('submit', () =>
        pin(Number(byId('pixel-x').value), Number(byId('pixel-y').value), true).catch(fail));
    byId('facts').addEventListener('click', followLinks);
    window.addEventListener('hashchange', () => { if (pixelOfAddress()) zoomTo(...pixelOfAddress())?.catch(fail); });
    new ResizeObserver(() => viewport.resize()).observe(byId('view'));
}

/** The pixel that the page's address names behind #, as in report.html#12,40. */
const pixelOfAddress = () => location.hash.match(/^#(-?\d+),(-?\d+)$/)?.slice(1).map(Number);

/** A row of facts; a fact with a pixel is a link to it. */
const factRow = ([name, value, pixel]) => [pixel ? make('a', { href: `#${pixel.join(',')}` }, name) : name, value];

/** Links lead to their pixel also when it is the address already. */
function followLinks(event) {
    const link = event.target.closest('a[href^="#"]');
    if (link && link.hash === location.hash) zoomTo(...pixelOfAddress())?.catch(fail);
}

function showFacts() {
    const parts = [];
    if (report.facts.length > 0) parts.push(makeTable('Measures', null, report.facts.map(factRow)));
    for (const image of images) {
        if (image.facts.length > 0) parts.push(makeTable(several ? image.short : 'Summary', null, image.facts.map(factRow)));
        if (image.omitted.length > 0)
            parts.push(make('p', {}, `Left out of ${image.short} to keep this page small: ${image.omitted.join(', ')}.`));
        if (image.metadata.length > 0)
            parts.push(make('details', {}, make('summary', {}, several ? `Metadata of ${image.short}` : 'Metadata'),
                makeTable('', null, image.metadata)));
    }
    byId('facts').classList.add('facts');
    byId('facts').replaceChildren(...parts);
    byId('facts').hidden = parts.length === 0;
}

function start() {
    document.title = byId('title').textContent = report.title;
    byId('subtitle').textContent = `${report.width}×${report.height} pixels`;
    byId('layout-choices').replaceChildren(...layouts.map(([id, label]) =>
        make('label', {}, make('input', { type: 'radio', name: 'layout', value: id }), label)));
    const names = images.map((image, k) => [k, image.short]);
    fillSelect(byId('image-a'), names, state.a);
    fillSelect(byId('image-b'), names, state.b);
    byId('keys').replaceChildren(makeTable('', null, keyTexts));
    if (!findLayer(imageA(), '')) state.layer = imageA().layers[0].name;
    showFacts();
    listen();
    showControls();
    viewport.resize();
    paint().then(() => {
        showControls();
        viewport.fit();
        if (pixelOfAddress()) return zoomTo(...pixelOfAddress());
        if (report.pixel) return pin(...report.pixel, true);
    }).catch(fail);
}

try {
    start();
} catch (error) {
    fail(error);
}
