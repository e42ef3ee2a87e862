// The panel beside the canvas: everything that is known about the pinned pixel.

import { certaintySentence } from './certainty.js';
import { axes, bandwidth, bandwidthWords, ellipse, symmetricIndex } from './covariance.js';
import { formatBriefly, formatExactly, formatNumber } from './format.js';
import { layerValues } from './layers.js';

/** An element with attributes and children; texts become text nodes and never markup. */
export function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
}

/** A table. rows: lists of texts; the first of each is its header. */
export function makeTable(caption, head, rows) {
    const table = make('table', {}, make('caption', {}, caption));
    if (head) table.append(make('thead', {}, make('tr', {}, ...head.map((h) => make('th', { scope: 'col' }, h)))));
    const body = make('tbody');
    for (const [name, ...cells] of rows)
        body.append(make('tr', {}, make('th', { scope: 'row' }, name), ...cells.map((c) => make('td', {}, c))));
    table.append(body);
    return make('div', { class: 'scroll' }, table);
}

function valueTable(planes, images, index) {
    const names = [];
    for (const image of images)
        for (const layer of image.layers)
            if (layer.name !== 'cov' && !names.includes(layer.name)) names.push(layer.name);
    const rows = [];
    for (const name of names) {
        const values = images.map((image) => layerValues(planes, image, name, index));
        const layer = images.map((image) => image.layers.find((l) => l.name === name)).find(Boolean);
        layer.channels.forEach((channel, c) => {
            const title = name === '' ? channel.name : `${name}.${channel.name}`;
            rows.push([title, ...values.map((v) => (v && c < v.length ? formatExactly(v[c]) : '–'))]);
        });
    }
    return makeTable('Values', ['channel', ...images.map((image) => image.short)], rows);
}

function samplesText(planes, image, index) {
    const one = (name) => layerValues(planes, image, name, index)?.[0];
    const [samples, density, error] = ['samples', 'density', 'error'].map(one);
    const parts = [];
    if (samples !== undefined) parts.push(`${formatNumber(samples)} samples taken`);
    if (density !== undefined) parts.push(`${formatNumber(density)} predicted`);
    if (error !== undefined) parts.push(`estimated standard error ${formatNumber(error)}`);
    return parts.join(', ');
}

export function filterOf(planes, image, index) {
    const filter = layerValues(planes, image, 'filter', index);
    return filter && ellipse(...filter);
}

function filterText(planes, image, index) {
    const e = filterOf(planes, image, index);
    return e && `Filter: a Gaussian of ${formatNumber(e.major)} by ${formatNumber(e.minor)} pixels (standard deviations), ` +
        `its long axis at ${formatNumber(Math.round(e.angle * 10) / 10)}°.`;
}

function bandwidthTable(planes, image, index) {
    const cov = layerValues(planes, image, 'cov', index);
    if (!cov || cov.length !== 15) return [];
    const weight = layerValues(planes, image, 'covweight', index)?.[0];
    if (weight === 0)
        return [make('p', {}, 'No path of the analysis found light here: the prediction comes from the neighbours.')];
    const rows = axes.map((axis, k) => {
        const value = bandwidth(cov, k);
        return [axis.name, `${formatNumber(value)} ${axis.unit}`, bandwidthWords(k, value)];
    });
    const matrix = axes.map((axis, i) => [axis.name, ...axes.map((_, j) => formatBriefly(cov[symmetricIndex(i, j)]))]);
    const words = makeTable('How fast the light varies (standard deviation of its spectrum)', ['axis', 'bandwidth', 'in words'], rows);
    words.classList.add('words');
    const result = [words];
    const spectrum = layerValues(planes, image, 'spectrum', index);
    if (spectrum) {
        const e = ellipse(...spectrum);
        result.push(make('p', {}, `Integrated over lens and shutter the image varies by up to ${formatNumber(e.major)} cycles/pixel ` +
            `at ${formatNumber(Math.round(e.angle * 10) / 10)}° and ${formatNumber(e.minor)} across.`));
    }
    result.push(makeTable('Covariance of the spectrum; pixels, aperture radii, shutters: products of their cycles',
        ['', ...axes.map((a) => a.name)], matrix));
    return result;
}

// The kinds of candidates, by the channels of the layer `share`.
const kCandidateKinds = [['denoiser', 'the denoiser'], ['regression', 'regressions'], ['gaussian', 'predicted Gaussians'], ['raw', 'the samples alone']];

function mixtureText(planes, image, index) {
    const values = layerValues(planes, image, 'share', index);
    if (!values) return undefined;
    const names = image.layers.find((l) => l.name === 'share').channels.map((c) => c.name);
    const parts = kCandidateKinds.filter(([kind]) => names.includes(kind))
        .map(([kind, title]) => `${(100 * values[names.indexOf(kind)]).toFixed(0)} % ${title}`);
    return `Made of: ${parts.join(', ')}.`;
}

/** Fills `panel` for the pixel with the given index. images: the images that are compared, each with a short name;
 *  size: their width and height. */
export function showPixel(panel, planes, images, index, size) {
    const parts = [];
    for (const image of images) {
        const section = [];
        const certainty = certaintySentence(planes, image, index, size);
        if (certainty) section.push(make('p', { class: 'certainty' }, `${certainty[0].toUpperCase()}${certainty.slice(1)}.`));
        const samples = samplesText(planes, image, index);
        if (samples) section.push(make('p', {}, samples + '.'));
        const filter = filterText(planes, image, index);
        if (filter) section.push(make('p', {}, filter));
        const mixture = mixtureText(planes, image, index);
        if (mixture) section.push(make('p', {}, mixture));
        section.push(...bandwidthTable(planes, image, index));
        if (section.length === 0) continue;
        if (images.length > 1) parts.push(make('h3', {}, image.short));
        parts.push(...section);
    }
    panel.replaceChildren(...parts, valueTable(planes, images, index));
}

