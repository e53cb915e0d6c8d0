// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpate::session {

/// An HDF5 file that is there whole or not at all, of groups and columns that grow. Throws InputError.
class Hdf5File {
 public:
  explicit Hdf5File(const std::filesystem::path& target);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Makes the groups on the way to `path` ("/a/b") where they are not there.
  void make_group(const std::string& path) const;
  void set_text(const std::string& object, const std::string& name, const std::string& text) const;
  /// Closes and puts it in place. Every column must be finished.
  void commit();

  /// One column of numbers, appended a chunk at a time.
  template <typename Number>
  class Column {
   public:
    Column(const Hdf5File& file, const std::string& path, const std::string& unit);
    void add(Number value);
    void finish();

   private:
    const Hdf5File* file_;
    std::string path_;
    std::vector<Number> waiting_;
    std::size_t written_ = 0;
  };

 private:
  [[noreturn]] void fail(const std::string& what) const;
  std::filesystem::path target_, temporary_;
  std::int64_t file_ = -1;
};

extern template class Hdf5File::Column<double>;
extern template class Hdf5File::Column<std::int64_t>;

}  // namespace palpate::session
