/// Names of files to write, checked before anything is done: none may be what the command reads.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gigabake::app {

/// Checks the file that `option` names, if it names one.
/// Errors  InputError: it is no regular file; it is one of `inputs` or lies in a folder of them, under any name (links
///         are followed, hard links are recognised).
void expect_no_input(const char* option, const std::string& name, const std::vector<std::filesystem::path>& inputs);

/// Checks that the folder of a file or folder that `option` names exists, so that a command fails before its work and
/// not after it. `made`: a folder that the command makes. Errors  InputError: the folder, and how to make it.
void expect_parent_folder(const char* option, const std::string& name, const std::filesystem::path& made = {});

/// As expect_no_input(), of a file that later runs of the command replace: what is there must begin as one of its own.
void expect_own_file(const char* option, const std::string& name, std::string_view beginning,
                     const std::vector<std::filesystem::path>& inputs);

/// Files and folders that a bake keeps in OUT, whether they are there yet or not.
std::vector<std::filesystem::path> files_of_bake(const std::filesystem::path& out);

}  // namespace gigabake::app
