#include <fmt/format.h>

#include <memory>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "core/error.h"

// Completion scripts are written from the parser itself, so that no option is missing from them.

namespace covtrace::cli {

namespace {

struct CompletedOption {
    std::vector<std::string> names;  ///< as typed: "--output", "-o"
    std::string help;
    std::vector<std::string> choices;  ///< choices of its value, where they are few words
    bool takes_value = false;
    bool takes_file = false;
};

struct CompletedCommand {
    std::string name, help;
    std::vector<CompletedOption> options;
};

/// The choices in a text such as "a|b|c", as the help shows them.
std::vector<std::string> choices_of(const std::string& text) {
    std::vector<std::string> choices;
    // A word in capitals, as in FILE|COLOUR, stands for what is not known.
    if (text.find('|') == std::string::npos || text.starts_with("FILE")) return choices;
    for (size_t from = 0; from <= text.size();) {
        const size_t to = std::min(text.find('|', from), text.size());
        choices.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    return choices;
}

std::vector<CompletedCommand> commands_of(const CLI::App& app) {
    std::vector<CompletedCommand> commands;
    for (const CLI::App* c : app.get_subcommands([](const CLI::App*) { return true; })) {
        CompletedCommand& command =
            commands.emplace_back(CompletedCommand{c->get_name(), c->get_description(), {}});
        for (const CLI::Option* o : c->get_options()) {
            if (!o->nonpositional()) continue;
            const std::string& text = o->get_option_text();
            CompletedOption option;
            option.help = o->get_description();
            option.choices = choices_of(text);
            for (const std::string& name : o->get_lnames()) option.names.push_back("--" + name);
            for (const std::string& name : o->get_snames()) option.names.push_back("-" + name);
            option.takes_value = o->get_expected_min() > 0;  // flags take none
            option.takes_file = text.starts_with("FILE") || text.starts_with("DIR");
            command.options.push_back(std::move(option));
        }
    }
    return commands;
}

std::string joined(const std::vector<CompletedCommand>& commands) {
    std::string names;
    for (const CompletedCommand& c : commands) names += (names.empty() ? "" : " ") + c.name;
    return names;
}

/// The text in a shell's single quotes.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
    return result + "'";
}

std::string bash_script(const std::vector<CompletedCommand>& commands) {
    std::string values, options;
    for (const CompletedCommand& c : commands) {
        std::string names;
        for (const CompletedOption& o : c.options) {
            std::string pattern;
            for (const std::string& name : o.names) {
                names += (names.empty() ? "" : " ") + name;
                pattern += fmt::format("{}\"{} {}\"", pattern.empty() ? "" : "|", c.name, name);
            }
            if (!o.takes_value || o.takes_file) continue;
            values += fmt::format("        {})\n", pattern);
            if (o.choices.empty())
                values += "            compopt +o default ;;\n";
            else
                values +=
                    fmt::format("            COMPREPLY=($(compgen -W \"{}\" -- \"$current\")) ;;\n",
                                fmt::join(o.choices, " "));
        }
        options += fmt::format("        {}) options=\"{}\" ;;\n", c.name, names);
    }
    return fmt::format(R"(# Completion of covtrace for bash.
_covtrace() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}} options=
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "{} --help --version" -- "$current"))
        return
    fi
    case "$command" in
{}    esac
    if [[ $current == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$current"))
        return
    fi
    case "$command $previous" in
{}    esac
}}
complete -o default -F _covtrace covtrace
)",
                       joined(commands), options, values);
}

std::string zsh_script(const std::vector<CompletedCommand>& commands) {
    const auto escaped = [](const std::string& text, std::string_view special) {
        std::string result;
        for (char c : text) {
            if (special.find(c) != std::string_view::npos) result += '\\';
            result += c;
        }
        return result;
    };
    std::string descriptions, cases;
    for (const CompletedCommand& c : commands) {
        descriptions += "        " + quoted(c.name + ":" + escaped(c.help, ":\\")) + "\n";
        cases += fmt::format("        {})\n            _arguments \\\n", c.name);
        for (const CompletedOption& o : c.options) {
            std::string action;
            if (o.takes_value)
                action = o.takes_file ? ":file:_files"
                         : o.choices.empty()
                             ? ":value: "
                             : fmt::format(":value:({})", fmt::join(o.choices, " "));
            for (const std::string& name : o.names)
                cases += "                " +
                         quoted(name + "[" + escaped(o.help, "[]:\\") + "]" + action) + " \\\n";
        }
        cases += "                '*:file:_files' ;;\n";
    }
    return fmt::format(R"(#compdef covtrace
# Completion of covtrace for zsh.
_covtrace() {{
    local -a commands=(
{}    )
    if (( CURRENT == 2 )); then
        _describe command commands
        return
    fi
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
{}    esac
}}
_covtrace "$@"
)",
                       descriptions, cases);
}

std::string fish_script(const std::vector<CompletedCommand>& commands) {
    std::string text = "# Completion of covtrace for fish.\n";
    const std::string none = "not __fish_seen_subcommand_from " + joined(commands);
    for (const CompletedCommand& c : commands)
        text += fmt::format("complete -c covtrace -f -n {} -a {} -d {}\n", quoted(none), c.name,
                            quoted(c.help));
    for (const CompletedCommand& c : commands)
        for (const CompletedOption& o : c.options) {
            text += "complete -c covtrace -n " + quoted("__fish_seen_subcommand_from " + c.name);
            for (const std::string& name : o.names)
                text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            if (o.takes_value) text += o.takes_file ? " -r -F" : " -x";
            if (!o.choices.empty())
                text += " -a " + quoted(fmt::format("{}", fmt::join(o.choices, " ")));
            text += " -d " + quoted(o.help) + "\n";
        }
    return text;
}

}  // namespace

void add_completion(CLI::App& app, Invocation& invocation) {
    auto shell = std::make_shared<std::string>();
    CLI::App* c = app.add_subcommand("completion", "Print a completion script for a shell");
    c->add_option("SHELL", *shell, "bash, zsh or fish")->required()->option_text(" ");
    c->callback([shell, &app, &invocation] {
        invocation.action = [shell, &app] {
            const std::vector<CompletedCommand> commands = commands_of(app);
            if (*shell == "bash")
                fmt::print("{}", bash_script(commands));
            else if (*shell == "zsh")
                fmt::print("{}", zsh_script(commands));
            else if (*shell == "fish")
                fmt::print("{}", fish_script(commands));
            else
                throw Error(ErrorKind::usage,
                            "completion: '" + *shell + "' is none of bash, zsh, fish");
            return 0;
        };
    });
}

}  // namespace covtrace::cli
