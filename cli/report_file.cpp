#include "cli/report_file.h"

#include "cli/message.h"

namespace covtrace::cli {

void write_report_file(const viewer::Report& report, const std::filesystem::path& file) {
    for (const viewer::OmittedLayer& o : viewer::write_report(report, file))
        say("warning: {}: the layer '{}' of {} is left out to keep the page below {} MiB; --crop "
            "shows a part with all layers\n",
            file.string(), o.layer, report.images[o.image].name, viewer::kMostReportBytes >> 20);
}

}  // namespace covtrace::cli
