"""Cameras and lenses against Cycles'."""

from addon_support import BlenderTest, HEIGHT, WIDTH, mean, render


class CameraTest(BlenderTest):
    def test_camera_sees_what_cycles_sees(self):
        self.plane(self.shining(), size=1.3)
        for values in (dict(), dict(shift_x=0.3, shift_y=0.1), dict(type="ORTHO", ortho_scale=4),
                       dict(sensor_fit="VERTICAL", lens=35)):
            for key, value in values.items():
                setattr(self.camera.data, key, value)
            ours, theirs = render("COVTRACE", 16), render("CYCLES", 16)
            for part in ((0, 0, 16, 12), (16, 0, 32, 12), (0, 12, 16, 24), (16, 12, 32, 24)):
                self.assertAlmostEqual(mean(ours, *part)[0], mean(theirs, *part)[0], delta=0.02, msg=str(values))

    def test_lens_blurs_as_in_cycles(self):
        self.plane(self.shining(), size=0.5)
        dof = self.camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 2.5, 0.05
        ours, theirs = render("COVTRACE", 256), render("CYCLES", 256)
        parts = [(0, 0, WIDTH, HEIGHT), (12, 8, 20, 16)]
        for part in parts:
            self.assertAlmostEqual(mean(ours, *part)[0] / mean(theirs, *part)[0], 1, delta=0.05)
        self.assertLess(mean(ours, *parts[1])[0], 0.8)  # it is blurred
