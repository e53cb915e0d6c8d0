// SPDX-License-Identifier: Apache-2.0
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/schema.hpp>

namespace palpate::session {

namespace {

/// A column without a type keeps a floating-point number as it is; REAL would lose the sign of -0.
struct Column {
  std::string_view name, type = {};
};

constexpr std::array<Column, 19> kFrameColumns{{{"id", "INTEGER PRIMARY KEY"},
                                                {"catheter", "INTEGER NOT NULL"},
                                                {"number", "INTEGER NOT NULL"},
                                                {"device_time_s"},
                                                {"received_ns", "INTEGER NOT NULL"},
                                                {"output_time_s"},
                                                {"given", "INTEGER NOT NULL"},
                                                {"tendon_moment_1_Nm"},
                                                {"tendon_moment_2_Nm"},
                                                {"tendon_sigma_Nm"},
                                                {"bend_1_per_m"},
                                                {"bend_2_per_m"},
                                                {"bend_sigma_1_per_m"},
                                                {"bend_sigma_2_per_m"},
                                                {"load_x_N"},
                                                {"load_y_N"},
                                                {"load_z_N"},
                                                {"load_sigma_N"},
                                                {"checksum", "INTEGER NOT NULL"}}};
constexpr std::array<Column, 11> kReadingColumns{{{"id", "INTEGER PRIMARY KEY"},
                                                  {"status", "TEXT NOT NULL"},
                                                  {"has_orientation", "INTEGER NOT NULL"},
                                                  {"q0"},
                                                  {"qx"},
                                                  {"qy"},
                                                  {"qz"},
                                                  {"tx_m"},
                                                  {"ty_m"},
                                                  {"tz_m"},
                                                  {"error_m"}}};
constexpr std::array<Column, 11> kEstimateColumns{{{"id", "INTEGER PRIMARY KEY"},
                                                   {"status", "TEXT NOT NULL"},
                                                   {"time_verdict", "TEXT NOT NULL"},
                                                   {"used", "INTEGER NOT NULL"},
                                                   {"sensors_used", "INTEGER NOT NULL"},
                                                   {"dof", "INTEGER NOT NULL"},
                                                   {"jumped", "INTEGER NOT NULL"},
                                                   {"evaluations", "INTEGER NOT NULL"},
                                                   {"rejections", "INTEGER NOT NULL"},
                                                   {"hidden", "INTEGER NOT NULL"},
                                                   {"checksum", "INTEGER NOT NULL"}}};
constexpr std::array<Column, 2> kExtraColumns{{{"id", "INTEGER PRIMARY KEY"}, {"lagged_age_frames", "INTEGER"}}};
constexpr std::array<Column, 8> kEventColumns{{{"id", "INTEGER PRIMARY KEY"},
                                               {"after_frame", "INTEGER NOT NULL"},
                                               {"catheter", "INTEGER NOT NULL"},
                                               {"received_ns", "INTEGER NOT NULL"},
                                               {"output_time_s"},
                                               {"name", "TEXT NOT NULL"},
                                               {"data", "TEXT NOT NULL"},
                                               {"checksum", "INTEGER NOT NULL"}}};

std::vector<Column> columns(Table table) {
  const auto joined = [](const auto& own, const auto& numbers) {
    std::vector<Column> all(own.begin(), own.end());
    for (const std::string_view name : numbers) all.push_back({name});
    return all;
  };
  constexpr std::array<std::string_view, 0> none{};
  switch (table) {
    case Table::kFrame:
      return joined(kFrameColumns, none);
    case Table::kReading:
      return joined(kReadingColumns, none);
    case Table::kEstimate:
      return joined(kEstimateColumns, estimate_number_names());
    case Table::kExtra:
      return joined(kExtraColumns, extra_number_names());
    case Table::kEvent:
      break;
  }
  return joined(kEventColumns, none);
}

constexpr std::array<std::string_view, kTables> kNames{"frame", "reading", "estimate", "estimate_extra", "event"};

/// `more`: columns that are made of others.
std::string create_sql(Table table, std::string_view more = {}) {
  std::vector<std::string> lines;
  for (const Column& column : columns(table))
    lines.push_back(column.type.empty() ? std::string(column.name) : fmt::format("{} {}", column.name, column.type));
  return fmt::format("CREATE TABLE {} (\n  {}{});\n", table_name(table), fmt::join(lines, ",\n  "), more);
}

constexpr std::string_view kHeadSql =
    "CREATE TABLE session (key TEXT PRIMARY KEY, value);\n"
    "CREATE TABLE catheter (id INTEGER PRIMARY KEY, name TEXT NOT NULL, file TEXT NOT NULL, toml TEXT NOT NULL);\n"
    "CREATE TABLE sensor (catheter INTEGER NOT NULL, position INTEGER NOT NULL, name TEXT NOT NULL,"
    " PRIMARY KEY (catheter, position));\n";
/// CROSS JOIN: frame by frame, or SQLite goes through all frames for every reading.
constexpr std::string_view kViewSql =
    "CREATE VIEW tracker AS SELECT catheter.name AS catheter, frame.number AS frame, frame.device_time_s AS time_s,"
    " sensor.name AS sensor, reading.status AS status, q0, qx, qy, qz, 1e3 * tx_m AS tx_mm, 1e3 * ty_m AS ty_mm,"
    " 1e3 * tz_m AS tz_mm, 1e3 * error_m AS error_mm FROM frame"
    " CROSS JOIN reading ON reading.id BETWEEN 16 * frame.id AND 16 * frame.id + 15"
    " CROSS JOIN catheter ON catheter.id = frame.catheter"
    " CROSS JOIN sensor ON sensor.catheter = frame.catheter AND sensor.position = reading.sensor;\n"
    "CREATE VIEW force AS SELECT catheter.name AS catheter, frame.number AS frame, estimate.time_s AS time_s,"
    " fx_tip_N, fy_tip_N, fz_tip_N, sqrt(cov_xx_N2) AS sigma_x_N, sqrt(cov_yy_N2) AS sigma_y_N,"
    " sqrt(cov_zz_N2) AS sigma_z_N, estimate.status AS status, sensors_used FROM frame"
    " CROSS JOIN estimate ON estimate.id = frame.id CROSS JOIN catheter ON catheter.id = frame.catheter;\n";

const std::string& first_step() {
  static const std::string sql = std::string(kHeadSql) + create_sql(Table::kFrame) +
                                 create_sql(Table::kReading,
                                            ",\n  frame INTEGER GENERATED ALWAYS AS (id >> 4) VIRTUAL,\n"
                                            "  sensor INTEGER GENERATED ALWAYS AS (id & 15) VIRTUAL") +
                                 create_sql(Table::kEstimate) + create_sql(Table::kExtra) + create_sql(Table::kEvent) +
                                 std::string(kViewSql);
  return sql;
}

}  // namespace

std::span<const std::string_view> schema_steps() {
  static const std::array<std::string_view, 1> steps{first_step()};
  return steps;
}

std::int64_t schema_version() { return static_cast<std::int64_t>(schema_steps().size()); }

std::string_view table_name(Table table) { return kNames[static_cast<std::size_t>(table)]; }

const std::vector<std::string>& column_names(Table table) {
  static const auto all = [] {
    std::array<std::vector<std::string>, kTables> made;
    for (std::size_t i = 0; i < kTables; ++i)
      for (const Column& column : columns(static_cast<Table>(i))) made[i].emplace_back(column.name);
    return made;
  }();
  return all[static_cast<std::size_t>(table)];
}

const std::string& insert_sql(Table table) {
  static const auto all = [] {
    std::array<std::string, kTables> made;
    for (std::size_t i = 0; i < kTables; ++i) {
      const auto& names = column_names(static_cast<Table>(i));
      made[i] = fmt::format("INSERT INTO {} ({}) VALUES ({})", kNames[i], fmt::join(names, ", "),
                            fmt::join(std::vector<std::string_view>(names.size(), "?"), ", "));
    }
    return made;
  }();
  return all[static_cast<std::size_t>(table)];
}

const std::string& select_sql(Table table) {
  static const auto all = [] {
    std::array<std::string, kTables> made;
    for (std::size_t i = 0; i < kTables; ++i)
      made[i] = fmt::format("SELECT {} FROM {} WHERE id >= ? AND id <= ? ORDER BY id",
                            fmt::join(column_names(static_cast<Table>(i)), ", "), kNames[i]);
    return made;
  }();
  return all[static_cast<std::size_t>(table)];
}

std::string checksum_key(std::int64_t catheter_id) { return fmt::format("catheter_{}_checksum", catheter_id); }

void write_head(const store::Database& database, const std::vector<SessionCatheter>& catheters,
                const WriterOptions& options) {
  const auto keep = [&](std::string_view key, auto value) {
    database.prepare("INSERT INTO session VALUES (?, ?)").bind(1, key).bind(2, value).run();
  };
  const auto now = std::chrono::system_clock::now();
  keep("program_version", std::string_view(options.program_version));
  keep("started",
       std::string_view(fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)))));
  keep("started_ns",
       static_cast<std::int64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count()));
  keep("durability", std::string_view(options.durability == Durability::kFull ? "FULL" : "NORMAL"));
  keep("batch_s", options.batch_s);
  std::int64_t id = 0;
  for (const SessionCatheter& catheter : catheters) {
    keep(checksum_key(id), checksum(catheter, id));
    database.prepare("INSERT INTO catheter VALUES (?, ?, ?, ?)")
        .bind(1, id)
        .bind(2, catheter.name)
        .bind(3, catheter.file)
        .bind(4, catheter.toml)
        .run();
    for (std::size_t i = 0; i < catheter.sensor_names.size(); ++i)
      database.prepare("INSERT INTO sensor VALUES (?, ?, ?)")
          .bind(1, id)
          .bind(2, static_cast<std::int64_t>(i))
          .bind(3, catheter.sensor_names[i])
          .run();
    ++id;
  }
}

}  // namespace palpate::session
