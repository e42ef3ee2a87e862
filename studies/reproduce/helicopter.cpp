#include <fmt/format.h>

#include "reproduce/experiment.h"
#include "reproduce/study.h"
#include "reproduce/thesis.h"

namespace covtrace::reproduce {

namespace {

/// Insets: the main rotor, the cabin in focus, the ground, the tail rotor before toys out of focus.
const std::vector<std::array<double, 4>> kInsets{{0.28, 0.08, 0.62, 0.34},
                                                 {0.24, 0.38, 0.52, 0.74},
                                                 {0.00, 0.52, 0.24, 0.86},
                                                 {0.66, 0.00, 0.90, 0.36}};

}  // namespace

Section helicopter(Workshop& workshop) {
    Section s;
    s.name = "helicopter";
    s.title = "helicopter: motion blur and depth of field at equal time (figure 5.11)";
    s.thesis =
        "The thesis renders a toy helicopter under a square light, its rotor turning about its "
        "axis, "
        "over a textured ground out of focus: 10 covariance paths, at most 200 samples a pixel, 29 "
        "minutes, beside the path tracer in the same time.";
    const SceneStudy& study =
        covtrace::reproduce::study(workshop, "helicopter", kHelicopterChoices);
    add_pictures(
        s, study, workshop, kInsets,
        "The toy helicopter: rotors that turn while the shutter is open, a patterned ground "
        "out of focus.");
    s.tables.push_back(comparison_table(study));
    s.data = to_json(study);
    s.resolution = study.scene->resolution;
    s.counts = study_counts(workshop);
    add_equal_time_claims(s, study, {{"covariance", 2.5}, {"hybrid", 4.0}}, workshop);
    s.notes.push_back(
        "The thesis' scene is not published: ours is a scene of its own with the same content. The "
        "thesis gives no error for it, so that only the image can be compared.");
    return s;
}

}  // namespace covtrace::reproduce
