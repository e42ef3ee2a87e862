// The certainty of a pixel in one sentence, as `covtrace inspect --pixel` tells it (cli/pixel_certainty.cpp).

import { axes, symmetricIndex } from './covariance.js';
import { formatNumber } from './format.js';
import { findLayer, layerValues } from './layers.js';

const kFloor = 0.01;  // constant in the denominator of relMSE
const kRare = 4;      // deviation of single samples over their mean from which paths are called rare
const kSpread = 0.25; // periods across aperture or shutter from which they are called the cause
const kReach = 2;     // half the width of the square of pixels that tell how samples vary

const square = (v) => v * v;
const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

function relativeError(planes, image, index) {
    const color = layerValues(planes, image, '', index);
    const error = layerValues(planes, image, 'error', index);
    if (!color || color.length < 3 || !error) return undefined;
    const r = error[0] / Math.sqrt(square(luminance(color)) + kFloor);
    return Number.isFinite(r) ? r : 0;
}

const wholeErrors = new Map();

/** Square root of the mean of the squared relative errors of an image. */
function imageError(planes, image, count) {
    if (!wholeErrors.has(image)) {
        let sum = 0;
        for (let i = 0; i < count; ++i) sum += square(relativeError(planes, image, i));
        wholeErrors.set(image, Math.sqrt(sum / count));
    }
    return wholeErrors.get(image);
}

/** Calls visit(index) for the square of pixels around one. */
function forAround(index, { width, height }, visit) {
    const x = index % width, y = Math.floor(index / width);
    for (let v = Math.max(0, y - kReach); v <= Math.min(height - 1, y + kReach); ++v)
        for (let u = Math.max(0, x - kReach); u <= Math.min(width - 1, x + kReach); ++u) visit(v * width + u);
}

function sampleDeviation(planes, image, index, size) {
    if (!['raw', 'variance', 'samples'].every((name) => findLayer(image, name))) return 0;
    let mean = 0, squares = 0, known = 0;
    forAround(index, size, (i) => {
        const [raw, variance, samples] = ['raw', 'variance', 'samples'].map((name) => layerValues(planes, image, name, i));
        const deviation = luminance(variance.map((c) => Math.sqrt(Math.max(0, c)))), light = luminance(raw);
        if (samples[0] < 2 || !Number.isFinite(deviation) || !Number.isFinite(light)) return;
        mean += light;
        squares += samples[0] * square(deviation);
        ++known;
    });
    return known > 0 && mean > 0 ? Math.sqrt(squares / known) / (mean / known) : 0;
}

/** Bandwidths of the axes, from the covariances of the pixels around by their weights. */
function bandwidthsAround(planes, image, index, size) {
    const sums = axes.map(() => 0);
    let weights = 0;
    forAround(index, size, (i) => {
        const cov = layerValues(planes, image, 'cov', i), weight = layerValues(planes, image, 'covweight', i)?.[0];
        if (!cov || cov.length !== 15 || weight === undefined) return;
        weights += weight;
        axes.forEach((_, k) => { sums[k] += weight * cov[symmetricIndex(k, k)]; });
    });
    return axes.map((axis, k) => (weights > 0 ? axis.scale * Math.sqrt(Math.max(0, sums[k] / weights)) : 0));
}

function cause(planes, image, index, size) {
    const deviation = sampleDeviation(planes, image, index, size);
    if (deviation > kRare) return `rare paths (single samples vary by ${formatNumber(Math.round(deviation))} times their mean): `;
    const [, , lensX, lensY, shutter] = bandwidthsAround(planes, image, index, size);
    const lens = Math.max(lensX, lensY);
    if (Math.max(lens, shutter) < kSpread) return '';
    return lens >= shutter ? 'out of focus: ' : 'in motion: ';
}

function percent(relative) {
    const value = 100 * relative;
    if (value < 0.1) return 'below 0.1 %';
    return `${value.toFixed(value < 9.95 ? 1 : 0)} %`;
}

/** The sentence, size being { width, height }; undefined without the layer `error`. */
export function certaintySentence(planes, image, index, size) {
    const relative = relativeError(planes, image, index);
    if (relative === undefined) return undefined;
    if (layerValues(planes, image, 'samples', index)?.[0] === 0)
        return 'no sample was taken here: what is shown comes from the pixels around';
    const whole = imageError(planes, image, size.width * size.height);
    const start = `${cause(planes, image, index, size)}error ${percent(relative)}`;
    if (relative <= whole) return `${start}, no more than the image's ${percent(whole)}`;
    const factor = square(relative / whole);
    const rounded = factor < 9.95 ? Math.round(10 * factor) / 10 : Math.round(factor);
    return `${start}, about ${formatNumber(rounded)} times the samples would bring it to the image's ${percent(whole)}`;
}
