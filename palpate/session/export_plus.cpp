// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <memory>
#include <palpate/recording/output_file.hpp>
#include <palpate/session/export.hpp>

namespace palpate::session {

namespace {

/// A transform as PLUS has it: INVALID where there is no pose, for the format knows neither points nor absence.
struct PlusTransform {
  bool valid = false;
  std::string text = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
};

PlusTransform transform_of(const SensorReading& reading, std::uint64_t& rounded) {
  const Eigen::Vector4d& q = reading.quaternion_wxyz;
  const bool whole = reading.status == SensorReading::Status::kOk && reading.has_orientation && q.allFinite() &&
                     reading.position_m.allFinite() && std::abs(q.norm() - 1.0) < 0.01;
  if (!whole) return {};
  const Matrix3d R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
  PlusTransform transform{.valid = true, .text = {}};
  for (int row = 0; row < 3; ++row)
    transform.text +=
        fmt::format("{} {} {} {} ", R(row, 0), R(row, 1), R(row, 2), millimetres(reading.position_m(row), rounded));
  transform.text += "0 0 0 1";
  return transform;
}

/// One MetaImage sequence; a pixel a frame, for there is no image.
class PlusSequence {
 public:
  PlusSequence(const std::string& path, const CatheterSummary& summary)
      : file_(path), names_(summary.catheter.sensor_names), frames_(summary.frames) {
    std::string fields;
    for (const std::string& name : names_)
      fields += fmt::format("{0}ToTrackerTransform {0}ToTrackerTransformStatus ", name);
    file_.write(fmt::format(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
        "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\n"
        "ElementSpacing = 1 1 1\nDimSize = 1 1 {}\nElementType = MET_UCHAR\nUltrasoundImageOrientation = MF\n"
        "UltrasoundImageType = BRIGHTNESS\nCustomFrameFieldNames = {}Timestamp UnfilteredTimestamp FrameNumber "
        "ImageStatus \n",
        frames_, fields));
  }
  void write(const LiveRecord& record, std::uint64_t place, std::int64_t number, std::uint64_t& rounded) {
    const std::string frame = fmt::format("Seq_Frame{:04}_", place);
    std::string text = fmt::format(
        "{0}FrameNumber = {1}\n{0}ImageStatus = OK\n{0}Timestamp = {2}\n"
        "{0}UnfilteredTimestamp = {2}\n",
        frame, number, record.frame.time_s);
    for (std::size_t i = 0; i < names_.size() && i < record.frame.readings.size(); ++i) {
      const PlusTransform transform = transform_of(record.frame.readings[i], rounded);
      text += fmt::format("{0}{1}ToTrackerTransform = {2}\n{0}{1}ToTrackerTransformStatus = {3}\n", frame, names_[i],
                          transform.text, transform.valid ? "OK" : "INVALID");
    }
    file_.write(text);
  }
  void commit() {
    file_.write("ElementDataFile = LOCAL\n");
    file_.write(std::string(frames_, '\0'));
    file_.commit();
  }

 private:
  OutputFile file_;
  std::vector<std::string> names_;
  std::uint64_t frames_;
};

}  // namespace

void export_plus_sequence(const ExportSource& source, ExportReport& report) {
  std::vector<std::unique_ptr<PlusSequence>> files(source.summary.catheters.size());
  for (const std::size_t i : source.chosen) {
    report.files.push_back(source.prefix_of(i) + ".igs.mha");
    files[i] = std::make_unique<PlusSequence>(report.files.back(), source.summary.catheters[i]);
  }
  std::vector<std::uint64_t> places(files.size());
  SessionReader reader(source.path);
  LiveRecord record;
  while (reader.next(record)) {
    const auto i = static_cast<std::size_t>(record.catheter);
    if (record.kind != LiveRecord::Kind::kFrame || !files[i]) continue;
    const std::uint64_t place = places[i]++;
    files[i]->write(record, place, source.number_of(record, place), report.rounded);
    ++report.frames;
  }
  for (const auto& one : files)
    if (one) one->commit();
}

}  // namespace palpate::session
