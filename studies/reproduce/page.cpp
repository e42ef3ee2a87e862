#include "reproduce/page.h"

#include <fmt/format.h>

#include <cmath>

#include "image/image.h"
#include "image/output_file.h"

namespace covtrace::reproduce {

namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light}
body{font:15px/1.5 system-ui,sans-serif;margin:0 auto;max-width:1180px;padding:1.5rem;color:#1a1a1a;background:#fff}
h1{font-size:1.7rem;line-height:1.2}h2{margin-top:3rem;border-bottom:2px solid #222;padding-bottom:.2rem}
figure{margin:1.5rem 0}figure svg{max-width:100%;height:auto;border:1px solid #ddd}
figcaption,caption{color:#333;font-size:.92rem;text-align:left;margin:.4rem 0}
.scroll{overflow-x:auto}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums;font-size:.92rem}
th,td{border-bottom:1px solid #ccc;padding:.3rem .7rem;text-align:left;vertical-align:top}
th{border-bottom:2px solid #666}
code{font:12.5px/1.4 ui-monospace,monospace;background:#f3f3f3;padding:.05rem .25rem;overflow-wrap:anywhere}
details{margin:.3rem 0;font-size:.9rem}details code{display:block;margin:.2rem 0}
.yes{color:#0a6b2d;font-weight:600}.no{color:#a61b12;font-weight:600}.note{background:#fff8e0;padding:.5rem .8rem;border-left:4px solid #e0b400}
.thesis{background:#eef4fb;padding:.5rem .8rem;border-left:4px solid #4a7fb5}
nav a{margin-right:1rem}
@media(max-width:900px){body{padding:.7rem}h1{font-size:1.3rem}figure svg{max-width:none;width:900px}.claims td{min-width:9rem}}
@media print{details{display:none}})";

std::string commands_html(const std::vector<std::string>& commands) {
    if (commands.empty()) return {};
    std::string s = fmt::format(
        "<details><summary>{}</summary>\n",
        commands.size() == 1 ? "the command that makes it" : "the commands that make it");
    for (const std::string& c : commands) s += "<code>" + escaped(c) + "</code>\n";
    return s + "</details>\n";
}

std::string claims_html(const std::vector<Claim>& claims) {
    if (claims.empty()) return {};
    std::string s =
        "<div class=\"scroll\"><table "
        "class=\"claims\">\n<thead><tr><th>claim</th><th>thesis</th><th>found "
        "here</th><th>asked for</th><th></th></tr></thead>\n<tbody>\n";
    for (const Claim& c : claims) {
        const std::string verdict = !c.holds   ? "<td>not judged</td>"
                                    : *c.holds ? "<td class=\"yes\">holds</td>"
                                               : "<td class=\"no\">does not hold</td>";
        s += fmt::format(
            "<tr id=\"{}\"><td>{}<details><summary>command</summary><code>{}</code></details></td>"
            "<td>{}</td><td>{}</td><td>{}</td>{}</tr>\n",
            escaped(c.name), escaped(c.statement), escaped(c.command), escaped(c.thesis),
            escaped(c.found), escaped(c.required), verdict);
    }
    return s + "</tbody></table></div>\n";
}

std::string table_html(const Table& t) {
    std::string s =
        "<div class=\"scroll\"><table>\n<caption>" + escaped(t.caption) + "</caption>\n<thead><tr>";
    for (const std::string& c : t.columns) s += "<th>" + escaped(c) + "</th>";
    s += "</tr></thead>\n<tbody>\n";
    for (const auto& row : t.rows) {
        s += "<tr>";
        for (const std::string& cell : row) s += "<td>" + escaped(cell) + "</td>";
        s += "</tr>\n";
    }
    return s + "</tbody></table></div>\n" + commands_html(t.commands);
}

std::string section_html(const Section& section) {
    std::string s =
        fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p class=\"thesis\">{}</p>\n",
                    escaped(section.name), escaped(section.title), escaped(section.thesis));
    if (!section.counts.empty())
        s += fmt::format("<p>{}x{} pixels; {}.</p>\n", section.resolution[0], section.resolution[1],
                         escaped(section.counts));
    if (!section.failure.empty())
        s += "<p class=\"no\">Not run: " + escaped(section.failure) + "</p>\n";
    for (const Figure& f : section.figures) {
        s += "<figure>\n<div class=\"scroll\">" + f.drawing.svg() + "</div><figcaption>" +
             escaped(f.caption) +
             fmt::format(
                 " Files: <a href=\"figures/{0}.png\">PNG</a>, <a "
                 "href=\"figures/{0}.svg\">SVG</a>.</figcaption>\n",
                 escaped(f.name)) +
             commands_html(f.commands) + "</figure>\n";
    }
    s += claims_html(section.claims);
    for (const Table& t : section.tables) s += table_html(t);
    for (const std::string& note : section.notes)
        s += "<p class=\"note\">" + escaped(note) + "</p>\n";
    for (const std::string& page : section.pages)
        s += fmt::format(
            "<p><a href=\"{0}\">{0}</a>: these images with all layers, to pan, zoom "
            "and flip between.</p>\n",
            escaped(page));
    return s + "</section>\n";
}

void write_text(const std::string& text, const std::filesystem::path& path) {
    OutputFile file(path);
    file.write(text.data(), text.size());
    file.commit();
}

}  // namespace

void write_page(const std::vector<Section>& sections, const PageFacts& facts,
                const std::filesystem::path& file) {
    std::string s =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
        "'unsafe-inline'; img-src data:\">\n<meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\">\n<title>Covariance tracing: the thesis' "
        "results, "
        "reproduced</title>\n<style>" +
        std::string(kStyle) + "</style>\n</head>\n<body>\n";
    s +=
        "<h1>Covariance tracing: the results of section 5.1 of Belcour's thesis, reproduced</h1>\n";
    s += "<p>Made by <code>" + escaped(facts.command) + "</code>, size “" + escaped(facts.size) +
         "”. Every figure, table and claim carries the command that makes it.";
    if (!facts.complete) s += " <strong class=\"no\">Not complete: the run has not ended.</strong>";
    s += "</p>\n<div class=\"scroll\"><table>";
    for (const auto& [name, value] : facts.facts)
        s += "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
    s += "</table></div>\n<nav>";
    for (const Section& section : sections)
        s += fmt::format("<a href=\"#{0}\">{0}</a> ", escaped(section.name));
    s += "</nav>\n";
    for (const Section& section : sections) s += section_html(section);
    write_text(s + "</body>\n</html>\n", file);
}

void write_results(const std::vector<Section>& sections, const PageFacts& facts,
                   const std::filesystem::path& file) {
    using nlohmann::json;
    json all = {{"command", facts.command},
                {"size", facts.size},
                {"complete", facts.complete},
                {"experiments", json::object()}};
    for (const auto& [name, value] : facts.facts) all["facts"][name] = value;
    for (const Section& section : sections) {
        json& e = all["experiments"][section.name];
        e = {{"title", section.title},     {"thesis", section.thesis},
             {"counts", section.counts},   {"resolution", section.resolution},
             {"notes", section.notes},     {"data", section.data},
             {"seconds_cpu", section.cpu}, {"seconds", section.wall},
             {"claims", json::object()},   {"figures", json::array()},
             {"tables", json::array()}};
        if (!section.failure.empty()) e["failure"] = section.failure;
        for (const Claim& c : section.claims)
            e["claims"][c.name] = {{"statement", c.statement},
                                   {"thesis", c.thesis},
                                   {"required", c.required},
                                   {"found", c.found},
                                   {"value", std::isfinite(c.value) ? json(c.value) : json()},
                                   {"holds", c.holds ? json(*c.holds) : json()},
                                   {"command", c.command}};
        for (const Figure& f : section.figures)
            e["figures"].push_back({{"file", "figures/" + f.name + ".png"},
                                    {"caption", f.caption},
                                    {"commands", f.commands}});
        for (const Table& t : section.tables)
            e["tables"].push_back({{"caption", t.caption},
                                   {"columns", t.columns},
                                   {"rows", t.rows},
                                   {"commands", t.commands}});
    }
    write_text(all.dump(2, ' ', false, json::error_handler_t::replace) + "\n", file);
}

void write_figures(const Section& section, const std::filesystem::path& folder) {
    const std::filesystem::path figures = folder / "figures";
    std::error_code error;
    std::filesystem::create_directories(figures, error);
    for (const Figure& f : section.figures) {
        const Picture p = f.drawing.pixels();
        write_png_rgb8(p.rgb, p.width, p.height, figures / (f.name + ".png"));
        write_text(f.drawing.svg(), figures / (f.name + ".svg"));
    }
}

}  // namespace covtrace::reproduce
