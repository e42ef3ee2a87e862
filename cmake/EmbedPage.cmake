# Writes OUTPUT, a C++ source with the viewer's page in one piece, from the folder PAGE and its MODULES (plain
# ES modules, in the order of their imports). All modules become one inline script: imports and the word
# `export` go, so that no two modules may have a top-level name in common.
set(script "\n")
foreach(module IN LISTS MODULES)
    file(READ "${PAGE}/${module}" text)
    string(REGEX REPLACE "import [^\n]* from '[^'\n]*';\n" "" text "${text}")
    string(REPLACE "\nexport " "\n" text "${text}")
    string(APPEND script "${text}\n")
endforeach()
file(READ "${PAGE}/style.css" style)
file(READ "${PAGE}/index.html" page)

# The page allows this script and this style sheet and no other, by their hashes.
string(SHA256 script_hash "${script}")
string(SHA256 style_hash "${style}")
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")

# Compilers limit the length of a literal.
function(append_literals name text)
    set(result "")
    string(LENGTH "${text}" left)
    set(at 0)
    while(at LESS left)
        string(SUBSTRING "${text}" ${at} 8000 piece)
        string(APPEND result "    R\"~~~(${piece})~~~\"sv,\n")
        math(EXPR at "${at} + 8000")
    endwhile()
    set(${name} "${result}" PARENT_SCOPE)
endfunction()
append_literals(literals "${page}")
file(WRITE "${OUTPUT}" "// Made by cmake/EmbedPage.cmake.
#include \"viewer/page.h\"
using namespace std::string_view_literals;
namespace covtrace::viewer {
static constexpr std::string_view kPieces[] = {
${literals}};
const PageTemplate kPage{kPieces, \"${script_hash}\", \"${style_hash}\"};
}  // namespace covtrace::viewer
")
