/// The noise that the guide to caustics leaves, measured on paths that it has led.
#include <algorithm>
#include <cmath>

#include "integrator/guides/caustic_guide.h"
#include "integrator/guides/path_lesson.h"

namespace covtrace {

namespace {

/// Brightness of a path, over that around its pixel, that counts: a single one that is brighter
/// would decide alone.
constexpr double kMostRelative = 1000;

}  // namespace

double CausticGuide::second_moment(const PathLesson& lesson) const {
    double with = 0, without = 0;
    for (const GuideBounce& b : lesson.bounces) {
        if (!b.is_guided) continue;
        const PlaceTree::Place& place = lesson.places[b.from];
        const GuideMixture guide = at(place.position, place.normal);
        if (!(guide.share() > 0)) continue;
        const float light = b.to < 0 ? b.found : b.found + b.passed * lesson.light[size_t(b.to)];
        const double own = double(b.bsdf_pdf);
        const double mixed = std::lerp(own, double(guide.pdf(b.direction)), double(guide.share()));
        const double survival = double(b.path_pdf) / mixed;
        const double brought = double(b.carried) * double(b.value) * double(light) / survival;
        // The mixture drew the bounce; the BSDF would have drawn it own / mixed times as often
        const double led = sqr(std::min(brought / mixed, kMostRelative));
        const double alone = sqr(std::min(brought / own, kMostRelative)) * own / mixed;
        if (!std::isfinite(led) || !std::isfinite(alone)) continue;
        with += led;
        without += alone;
    }
    if (!(without > 0)) return 1;
    const double all = std::max(without, lesson.second_moment + without - with);
    return 1 - std::min((without - with) / all, 1 - with / without);
}

}  // namespace covtrace
