// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cassert>
#include <palpate/math/units.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/recording/output_file.hpp>

namespace palpate {

void write_tracker_csv(const std::filesystem::path& path, const Catheter& catheter,
                       std::span<const TrackerFrame> frames) {
  OutputFile file(path);
  write_tracker_csv(file, catheter, frames);
  file.commit();
}

void write_tracker_csv(OutputFile& file, const Catheter& catheter, std::span<const TrackerFrame> frames) {
  file.write("time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n");
  for (const TrackerFrame& frame : frames) {
    for (std::size_t i = 0; i < frame.readings.size(); ++i) {
      const SensorReading& r = frame.readings[i];
      if (r.status == SensorReading::Status::kAbsent) continue;
      const std::string& name = i < catheter.sensors.size() ? catheter.sensors[i].name : catheter.base.sensor.name;
      const std::string row = fmt::format("{:.6f},{},{},", frame.time_s, frame.number, name);
      if (r.status == SensorReading::Status::kMissing) {
        file.write(row + "MISSING,,,,,,,,\n");
        continue;
      }
      const auto& q = r.quaternion_wxyz;
      const Vector3d t = r.position_m * kMillimetresPerMetre;
      const std::string rotation =
          r.has_orientation ? fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}", q(0), q(1), q(2), q(3)) : ",,,";
      file.write(row + fmt::format("OK,{},{:.3f},{:.3f},{:.3f},\n", rotation, t.x(), t.y(), t.z()));
    }
  }
}

void write_force_csv(const std::filesystem::path& path, std::span<const TrackerFrame> frames,
                     std::span<const Vector3d> force_tip_N, std::span<const Vector3d> force_base_N) {
  assert(frames.size() == force_tip_N.size() && frames.size() == force_base_N.size());
  OutputFile file(path);
  file.write("time_s,fx_tip_N,fy_tip_N,fz_tip_N,fx_base_N,fy_base_N,fz_base_N\n");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3d &f = force_tip_N[i], &b = force_base_N[i];
    file.write(fmt::format("{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", frames[i].time_s, f.x(), f.y(), f.z(),
                           b.x(), b.y(), b.z()));
  }
  file.commit();
}

}  // namespace palpate
