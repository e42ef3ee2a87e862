// The keys and their actions.

import { change, fail, flip, nextDifference, setSplit, stepLayer } from './actions.js';
import { movePin } from './pixel.js';
import { byId, several, state, viewport } from './session.js';

const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const brighter = (stops) => change({ exposure: Math.min(10, Math.max(-10, state.exposure + stops)) });

/** Actions by key. Keys that are not in `texts` go with the one before. */
const actions = {
    '+': () => viewport.zoom(1.5),
    '=': () => viewport.zoom(1.5),
    '-': () => viewport.zoom(1 / 1.5),
    0: () => viewport.fit(),
    1: () => viewport.actualSize(),
    e: () => brighter(0.5),
    E: () => brighter(-0.5),
    r: () => change({ exposure: 0, range: null }),
    l: () => stepLayer(1),
    L: () => stepLayer(-1),
    '?': () => byId('help').showModal(),
};
const comparing = {
    f: flip,
    s: () => change({ layout: 'split' }),
    ',': () => setSplit(viewport.split - 0.02),
    '.': () => setSplit(viewport.split + 0.02),
    b: () => change({ layout: 'side' }),
    d: nextDifference,
};
if (several) Object.assign(actions, comparing);

/** Texts for the list of keys. */
export const keyTexts = [
    ['←↑→↓', 'move the chosen pixel (with Shift by ten)'],
    ['+ −', 'zoom; also the wheel'],
    ['0', 'fit the image into the window'],
    ['1', 'one screen pixel per image pixel'],
    ['e E', 'half a stop brighter, darker'],
    ['r', 'exposure and range as they were'],
    ['l L', 'next layer, previous layer'],
    ...(several ? [
        ['f', 'flip between A and B'],
        ['s', 'split'],
        [', .', 'move the split line'],
        ['b', 'side by side'],
        ['d', 'difference; again: the next kind'],
    ] : []),
    ['?', 'this list'],
];

export function onKey(event) {
    const target = event.target;
    const typing = target.matches?.('select, input:not([type="radio"])') || byId('help').open;
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const onCanvas = target === byId('view') || target === document.body;
    const step = event.shiftKey ? 10 : 1;
    if (onCanvas && arrows[event.key]) movePin(step * arrows[event.key][0], step * arrows[event.key][1]).catch(fail);
    else if (Object.hasOwn(actions, event.key)) actions[event.key]();
    else return;
    event.preventDefault();
}
