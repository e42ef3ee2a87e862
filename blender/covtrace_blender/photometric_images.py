"""Images of the photometric files of lamps, in the folder of the scene."""

import hashlib
import os

import numpy as np

from .export_textures import write_pfm
from .photometry import Profile


class PhotometricImages:
    """Makes each image and each file once: a house has a hundred lamps of one kind."""

    def __init__(self, folder, source=None):
        """source: pixels of images, as TextureFiles has it."""
        self.folder, self.source, self._profiles, self._images, self._files, self._emissions = folder, source, {}, {}, {}, {}

    def of(self, text, directions):
        """The intensity that a file's text has in directions: for a matrix (3, 3) the image that it makes, for a vector one number. Raises
        Damaged."""
        if text not in self._profiles:
            self._profiles[text] = Profile(text)
        profile = self._profiles[text]
        if directions.ndim == 1:
            return profile.at(directions)
        # The length of directions does not matter.
        key = text, np.round(directions / np.linalg.norm(directions), 6).tobytes()
        if key not in self._images:
            self._images[key] = profile.image(directions)
        return self._images[key]

    def emission(self, lamp):
        """The colour and image that a LampEmission reads, once for all lamps that are alike."""
        key = lamp.key()
        if key not in self._emissions:
            self._emissions[key] = lamp.read()
        return self._emissions[key]

    def write(self, image):
        """The name of the file that holds an image, (h, w) or (h, w, 3)."""
        values = np.ascontiguousarray(image, np.float32)
        digest = hashlib.sha256(values.tobytes()).digest()
        if digest not in self._files:
            self._files[digest] = f"lamp{len(self._files)}.pfm"
            write_pfm(os.path.join(self.folder, self._files[digest]), values if values.ndim == 3 else np.repeat(values[..., None], 3, -1))
        return self._files[digest]
