// Changes of the state, from wherever they come.

import { showControls } from './controls.js';
import { paint } from './painting.js';
import { byId, flipPlane, layerNames, possibleKinds, state, viewport } from './session.js';

export function fail(error) {
    const failure = byId('failure');
    failure.hidden = false;
    failure.textContent = `This report cannot be shown: ${error.message ?? error}`;
}

export function change(values) {
    // A range belongs to the layer and component that it was chosen for.
    if (['layout', 'layer', 'component', 'kind', 'a', 'b'].some((k) => k in values)) state.range = null;
    Object.assign(state, values);
    if (state.kind === 'flip' && flipPlane() === undefined) state.kind = 'absolute';
    return paint().then(showControls).catch(fail);
}

export function setSplit(share) {
    viewport.split = Math.min(1, Math.max(0, share));
    byId('split').value = 100 * viewport.split;
    viewport.draw();
}

export const flip = () => change({ layout: state.layout === 'a' ? 'b' : 'a' });

export function nextDifference() {
    if (state.layout !== 'difference') return change({ layout: 'difference' });
    const kinds = possibleKinds();
    return change({ kind: kinds[(kinds.findIndex((k) => k.id === state.kind) + 1) % kinds.length].id });
}

export function stepLayer(step) {
    const names = layerNames();
    return change({ layer: names[(names.indexOf(state.layer) + step + names.length) % names.length] });
}
