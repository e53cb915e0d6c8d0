// SPDX-License-Identifier: Apache-2.0
#include "reproduce_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <palpate/math/errors.hpp>
#include <palpate/recording/output_file.hpp>
#include <vector>

namespace palpate::app {

namespace {

namespace fs = std::filesystem;

/// A folder inside another, removed again with all that is still in it; the outer one too, where it was made for it.
class StagingFolder {
 public:
  explicit StagingFolder(const fs::path& target) : target_(target), path_(target / ".palpate-reproduce") {
    std::error_code error;
    made_target_ = fs::create_directory(target_, error);
    if (!error) fs::create_directory(path_, error);
    if (error) throw InputError(fmt::format("--out {}: cannot be written: {}", target_.string(), error.message()));
  }
  ~StagingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (made_target_ && !kept_) fs::remove(target_, ignored);
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  fs::path file(const std::string& name) const { return path_ / name; }
  /// All or none: what may fail, a folder of that name, is looked for first.
  void put_in_place(const std::vector<std::string>& names) {
    for (const std::string& name : names) refuse_folder(target_ / name);
    for (const std::string& name : names) {
      std::error_code error;
      fs::rename(path_ / name, target_ / name, error);
      if (error) throw InputError(fmt::format("{}: {}", (target_ / name).string(), error.message()));
    }
    kept_ = true;
  }

 private:
  static void refuse_folder(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
      throw InputError(fmt::format("{}: is a directory: expected a file, or nothing", path.string()));
  }

  fs::path target_, path_;
  bool made_target_ = false, kept_ = false;
};

}  // namespace

void check_folder(const std::string& folder) {
  const fs::path typed(folder), path = typed.has_filename() ? typed : typed.parent_path();  // "page/" is "page"
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (fs::exists(path) && !fs::is_directory(path))
    throw InputError(fmt::format("--out {}: expected a folder, or the name of a new one", folder));
  if (!fs::exists(path) && !fs::is_directory(parent))
    throw InputError(fmt::format("--out {}: the folder {} does not exist", folder, parent.string()));
  const StagingFolder writable{path};  // now, not after minutes of work
}

void write_page(const std::string& folder, const std::string& page, std::span<const reproduction::Part> parts) {
  StagingFolder staging{fs::path(folder)};
  std::vector<std::string> names;
  for (const reproduction::Part& part : parts)
    for (const reproduction::NamedFigure& figure : part.figures) {
      names.push_back(figure.name + ".svg");
      plot::write_figure(figure.figure, staging.file(names.back()));
    }
  names.emplace_back(kPageName);
  OutputFile file(staging.file(kPageName));
  file.write(page);
  file.commit();
  staging.put_in_place(names);
}

}  // namespace palpate::app
