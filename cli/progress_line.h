/// Progress on standard error: one line that is redrawn on a terminal, plain lines elsewhere, or
/// lines for programs.
#pragma once

#include <functional>

#include "core/enum_names.h"
#include "render/progress.h"

namespace covtrace::cli {

enum class ProgressStyle {
    automatic,  ///< bar on a terminal, plain elsewhere
    bar,
    plain,
    percent,  ///< "42%"; whole, rounded down; "100%" only when all files are there
    json,     ///< one object a line: phase, fraction, spp, error, elapsed, remaining,
              ///< samples_per_second
    none
};

}  // namespace covtrace::cli

namespace covtrace {

template <>
inline constexpr auto kEnumNames<cli::ProgressStyle> =
    enum_names<cli::ProgressStyle>({{cli::ProgressStyle::automatic, "auto"},
                                    {cli::ProgressStyle::bar, "bar"},
                                    {cli::ProgressStyle::plain, "plain"},
                                    {cli::ProgressStyle::percent, "percent"},
                                    {cli::ProgressStyle::json, "json"},
                                    {cli::ProgressStyle::none, "none"}});

}  // namespace covtrace

namespace covtrace::cli {

class ProgressLine {
  public:
    explicit ProgressLine(ProgressStyle style);
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    /// Sets the number of the image's pixels, for the samples per second.
    void set_pixels(double pixels) { pixels_ = pixels; }
    /// Tells that the scene is being read.
    void begin();
    /// Arguments for Monitor: the function that reports, and the seconds between two reports.
    std::function<void(const Progress&)> reporter();
    double interval() const;
    /// Removes the bar, if there is one, so that messages can be written.
    void clear();
    /// Tells that all files are there: the only 100 %. `error` is the one that was told last.
    void done(double samples_per_pixel, double elapsed, double error);

  private:
    void report(const Progress& p);

    ProgressStyle style_;
    double pixels_ = 0;
    bool open_ = false;  ///< a bar stands on the last line
};

}  // namespace covtrace::cli
