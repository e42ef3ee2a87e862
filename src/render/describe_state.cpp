#include "render/describe_state.h"

#include <iomanip>
#include <sstream>

namespace covtrace {

namespace {

std::string stage_name(const RenderState& s) {
    switch (s.stage) {
        case Stage::first_paths:
            return "the first covariance paths";
        case Stage::pilot:
            return "the pilot";
        case Stage::rounds:
            break;
    }
    return "a round";
}

/// Words for how far the render is, and what comes next.
std::string standing(const RenderState& s) {
    std::ostringstream out;
    out << s.mean_count() << " samples per pixel taken";
    if (s.in_round()) {
        out << ", in " << stage_name(s) << " to " << s.target;
        if (s.shards > 1 && s.reached({s.present.front(), s.shards}))
            out << ", all of this shard's";
    } else if (!s.complete) {
        out << "; " << stage_name(s) << " comes next";
    }
    out << (s.complete ? "; complete" : "; not complete");
    return out.str();
}

}  // namespace

std::string describe(const RenderState& s) {
    std::ostringstream out;
    const auto line = [&out](const std::string& name) -> std::ostream& {
        return out << std::left << std::setw(16) << name;
    };
    line("pixels") << s.region.width() << "x" << s.region.height() << ", " << name_of(s.method)
                   << "\n";
    line("state") << standing(s) << "\n";
    if (s.spp) line("budget") << *s.spp << " samples per pixel\n";
    if (s.shards > 1) {
        line("shards");
        for (int k : s.present) out << k + 1 << "/" << s.shards << " ";
        out << "\n";
    }
    line("not finite") << s.rejected << " samples";
    for (const RejectedSample& r : s.first_rejected)
        out << (&r == s.first_rejected.data() ? ", at x,y,sample = " : " ") << r.x << "," << r.y
            << "," << r.sample;
    out << "\n";
    for (const auto& [name, bytes] : s.memory())
        line(name) << bytes << " bytes"
                   << "\n";
    for (const auto& [name, value] : s.identity) out << "  " << name << ": " << value << "\n";
    return out.str();
}

}  // namespace covtrace
