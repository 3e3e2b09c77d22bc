/// Checks of output file names before the work starts: an output file must not be an input of the command.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gigabake::app {

/// Checks the file that `option` names; does nothing if `name` is empty.
/// Errors  InputError: the file is not a regular file, is one of `inputs`, or lies in a folder of `inputs`. Links are
///         followed and hard links are recognised.
void expect_no_input(const char* option, const std::string& name, const std::vector<std::filesystem::path>& inputs);

/// Checks that the parent folder of the path of `option` exists, so that a command fails before its work. `made` is a
/// folder that the command creates itself; it need not exist.
/// Errors  InputError: the folder is missing, or it is a file. The message for a missing folder names the command that
///         creates it.
void expect_parent_folder(const char* option, const std::string& name, const std::filesystem::path& made = {});

/// Checks a file that later runs replace, like expect_no_input(). In addition, an existing file must begin with
/// `beginning` or be empty.
void expect_own_file(const char* option, const std::string& name, std::string_view beginning,
                     const std::vector<std::filesystem::path>& inputs);

/// Returns the files and folders that a bake keeps in SCENE, including those that do not exist yet.
std::vector<std::filesystem::path> files_of_bake(const std::filesystem::path& out);

}  // namespace gigabake::app
