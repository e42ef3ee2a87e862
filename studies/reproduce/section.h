/// The result of an experiment, which the page shows and results.json holds.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reproduce/drawing.h"

namespace covtrace::reproduce {

struct Figure {
    std::string name;  ///< name of the files figures/NAME.png and .svg
    std::string caption;
    Drawing drawing;
    std::vector<std::string> commands;  ///< commands that render the images shown
};

struct Table {
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> commands;
};

/// A statement that is a number.
struct Claim {
    std::string name;  ///< key in results.json
    std::string statement;
    std::string thesis;    ///< the result that Belcour 2012 reports, or empty
    std::string required;  ///< demand in words, or empty where there is none
    std::string found;     ///< finding in words, with the spread where there is one
    double value = 0;      ///< finding as one number
    std::optional<bool> holds;
    std::string command;  ///< command that finds it
};

struct Section {
    std::string name, title;
    std::string thesis;               ///< the result that Belcour 2012 shows
    std::array<int, 2> resolution{};  ///< of its images, pixels
    std::string counts;               ///< samples per pixel and seeds, in words
    std::vector<std::string> notes;  ///< remarks; also: parts that could not be reproduced, and why
    std::vector<Figure> figures;
    std::vector<Table> tables;
    std::vector<Claim> claims;
    std::vector<std::string> pages;                  ///< files of the viewer beside the page
    std::string failure;                             ///< reason why it was not run
    nlohmann::json data = nlohmann::json::object();  ///< all numbers
    double cpu = 0, wall = 0;                        ///< seconds that the experiment took
};

}  // namespace covtrace::reproduce
