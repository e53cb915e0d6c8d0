// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/session/hdf5_file.hpp>
#include <type_traits>

namespace palpate::session {

namespace {

constexpr hsize_t kChunk = 4096;

/// An HDF5 handle, given back at the end of its scope; below zero it is none.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

template <typename Number>
hid_t memory_type() {
  if constexpr (std::is_same_v<Number, double>)
    return H5T_NATIVE_DOUBLE;
  else
    return H5T_NATIVE_INT64;
}

bool put_text(hid_t file, const std::string& object, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type, std::max<std::size_t>(text.size(), 1));
  H5Tset_cset(type, H5T_CSET_UTF8);
  const Handle attribute(
      H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  return attribute >= 0 && H5Awrite(attribute, type, text.empty() ? "\0" : text.data()) >= 0;
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& target)
    : target_(target),
      temporary_(target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid())) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its own words go to stderr; ours name the file
  file_ = H5Fcreate(temporary_.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
  if (file_ < 0) fail("cannot be written");
}

Hdf5File::~Hdf5File() {
  if (file_ >= 0) H5Fclose(file_);
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
}

void Hdf5File::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}: {}", target_.string(), what, errno != 0 ? std::strerror(errno) : "HDF5 fails"));
}

void Hdf5File::make_group(const std::string& path) const {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    if (H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) {
      const Handle group(H5Gcreate2(file_, part.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
      if (group < 0) fail(fmt::format("group {} cannot be made", part));
    }
    if (end == std::string::npos) return;
  }
}

void Hdf5File::set_text(const std::string& object, const std::string& name, const std::string& text) const {
  if (!put_text(file_, object, name, text)) fail(fmt::format("attribute {} of {} cannot be written", name, object));
}

void Hdf5File::commit() {
  const bool closed = H5Fclose(file_) >= 0;
  file_ = -1;
  if (!closed || std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written");
  temporary_.clear();
}

template <typename Number>
Hdf5File::Column<Number>::Column(const Hdf5File& file, const std::string& path, const std::string& unit)
    : file_(&file), path_(path) {
  const hsize_t none = 0, unlimited = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose), layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout, 1, &kChunk);
  const Handle set(H5Dcreate2(file.file_, path.c_str(), memory_type<Number>(), space, H5P_DEFAULT, layout, H5P_DEFAULT),
                   H5Dclose);
  if (set < 0) file.fail(fmt::format("dataset {} cannot be made", path));
  if (!unit.empty()) file.set_text(path, "unit", unit);
}

template <typename Number>
void Hdf5File::Column<Number>::add(Number value) {
  waiting_.push_back(value);
  if (waiting_.size() == kChunk) finish();
}

template <typename Number>
void Hdf5File::Column<Number>::finish() {
  if (waiting_.empty()) return;
  const hsize_t first = written_, count = waiting_.size(), all = first + count;
  const Handle set(H5Dopen2(file_->file_, path_.c_str(), H5P_DEFAULT), H5Dclose);
  bool written = set >= 0 && H5Dset_extent(set, &all) >= 0;
  const Handle space(written ? H5Dget_space(set) : -1, H5Sclose),
      memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
  written = written && H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr) >= 0 &&
            H5Dwrite(set, memory_type<Number>(), memory, space, H5P_DEFAULT, waiting_.data()) >= 0;
  if (!written) file_->fail(fmt::format("dataset {} cannot be written", path_));
  written_ += waiting_.size();
  waiting_.clear();
}

template class Hdf5File::Column<double>;
template class Hdf5File::Column<std::int64_t>;

}  // namespace palpate::session
