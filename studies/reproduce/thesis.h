/// Results of Belcour 2012, section 5.1, and the claims that stand beside them.
#pragma once

#include <map>

#include "reproduce/study.h"

namespace covtrace::reproduce {

inline const ThesisChoices kSnookerChoices{kSnookerScene, 15, 100, 3000};
inline const ThesisChoices kHelicopterChoices{"helicopter", 10, 200, std::nullopt};

/// Samples per pixel and seeds of a study, in words.
std::string study_counts(const Workshop& workshop);

/// Adds claims on the path tracer's time over ours at equal error, which is to be at least so much
/// for each method. Demands are made of the full size: at others nothing is judged.
void add_equal_error_claims(Section& section, const SceneStudy& study,
                            const std::map<std::string, double>& least, const std::string& thesis,
                            const Workshop& workshop);
/// Adds the claim that the choices of Belcour 2012 have the ratio that it prints: judged at every
/// size at which errors mean something, as that budget of samples does not depend on the size.
void add_printed_ratio_claim(Section& section, const SceneStudy& study, const Workshop& workshop);
/// Adds claims on the path tracer's error over ours at equal time.
void add_equal_time_claims(Section& section, const SceneStudy& study,
                           const std::map<std::string, double>& least, const Workshop& workshop);
/// Adds claims on the shares of the analysis and of the reconstruction in the time of `covariance`.
/// They are judged at the full size alone, too.
void add_share_claims(Section& section, const SceneStudy& study, const Workshop& workshop);

}  // namespace covtrace::reproduce
