// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <igtlCapabilityMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlPositionMessage.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <igtlUnit.h>
#include <igtl_unit.h>
#include <igtl_util.h>

#include <list>
#include <random>
#include <tests/link/library_peer.hpp>

/// The codec against Debian's libopenigtlink 1.11, an implementation that shares no line with it: what the library
/// writes is read, and the library reads what is written, to the last bit.
namespace palpate::link::test {
namespace {

Message one(const Bytes& bytes) {
  Decoded back = decoded(bytes);
  EXPECT_EQ(back.messages.size(), 1U) << back.fault;
  return back.messages.empty() ? Message{} : back.messages[0];
}

template <typename OfBody>
OfBody body_of(igtl::MessageBase& message) {
  message.SetDeviceName("Library");
  message.SetTimeStamp(1467000000, 0x80000000);
  const Message back = one(packed(message));
  EXPECT_EQ(back.device, "Library");
  EXPECT_EQ(back.time_s, 1467000000.5);
  EXPECT_EQ(back.version, 1);
  EXPECT_TRUE(std::holds_alternative<OfBody>(back.body));
  return std::get<OfBody>(back.body);
}

Bytes ours(Body body) {
  return encoded({.version = 1, .device = "Palpate", .time_s = 3.25, .body = std::move(body), .metadata = {}});
}

/// The library has rows: its [i][j] is our column j.
void fill(igtl::Matrix4x4& matrix, const Matrix& from) {
  igtl::IdentityMatrix(matrix);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) matrix[i][j] = from.columns[3 * j + i];
}

Matrix taken(const igtl::Matrix4x4& matrix) {
  Matrix back;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) back.columns[3 * j + i] = matrix[i][j];
  return back;
}

TEST(LinkLibrary, Crc) {
  std::mt19937 random(7);
  for (std::size_t length = 0; length < 300; ++length) {
    Bytes bytes(length);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 0xFF);
    EXPECT_EQ(crc64(bytes), ::crc64(reinterpret_cast<unsigned char*>(bytes.data()), length, 0)) << length;
  }
}

TEST(LinkLibrary, Newton) {
  const auto unit = igtl::Unit::New();
  unit->Append(IGTL_UNIT_SI_DERIVED_NEWTON, 1);
  EXPECT_EQ(kNewton, unit->Pack());
}

TEST(LinkLibrary, Header) {
  const auto header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), ours(GetCapability{}).data(), IGTL_HEADER_SIZE);
  header->Unpack();
  unsigned int seconds = 0, fraction = 0;
  header->GetTimeStamp(&seconds, &fraction);
  EXPECT_EQ(seconds, 3U);
  EXPECT_EQ(fraction, 0x40000000U);
  EXPECT_STREQ(header->GetDeviceName(), "Palpate");
  EXPECT_STREQ(header->GetDeviceType(), "GET_CAPABIL");
  EXPECT_EQ(header->GetBodySizeToRead(), 0);
}

TEST(LinkLibrary, Transform) {
  const auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  fill(matrix, example_matrix());
  message->SetMatrix(matrix);
  EXPECT_EQ(body_of<link::Transform>(*message).matrix, example_matrix());

  unpacked<igtl::TransformMessage>(ours(link::Transform{example_matrix()}))->GetMatrix(matrix);
  EXPECT_EQ(taken(matrix), example_matrix());
}

TEST(LinkLibrary, TrackingData) {
  const auto message = igtl::TrackingDataMessage::New();
  igtl::Matrix4x4 matrix;
  for (const char* const name : {"Tip", "Base"}) {
    auto element = igtl::TrackingDataElement::New();
    element->SetName(name);
    element->SetType(igtl::TrackingDataElement::TYPE_5D);
    fill(matrix, example_matrix());
    element->SetMatrix(matrix);
    message->AddTrackingDataElement(element);
  }
  const TrackingData expected{{{"Tip", 4, example_matrix()}, {"Base", 4, example_matrix()}}};
  EXPECT_EQ(body_of<TrackingData>(*message), expected);

  const auto back = unpacked<igtl::TrackingDataMessage>(ours(expected));
  ASSERT_EQ(back->GetNumberOfTrackingDataElements(), 2);
  igtl::TrackingDataElement::Pointer element;
  back->GetTrackingDataElement(1, element);
  EXPECT_STREQ(element->GetName(), "Base");
  EXPECT_EQ(element->GetType(), 4);
  element->GetMatrix(matrix);
  EXPECT_EQ(taken(matrix), example_matrix());
}

TEST(LinkLibrary, QuaternionTrackingData) {
  const auto message = igtl::QuaternionTrackingDataMessage::New();
  auto element = igtl::QuaternionTrackingDataElement::New();
  element->SetName("Tip");
  element->SetType(igtl::QuaternionTrackingDataElement::TYPE_6D);
  element->SetPosition(1.5f, -2, 3);
  element->SetQuaternion(0, 0.6f, 0, 0.8f);
  message->AddQuaternionTrackingDataElement(element);
  const QuaternionTrackingData expected{{{"Tip", 2, {1.5f, -2, 3}, {0, 0.6f, 0, 0.8f}}}};
  EXPECT_EQ(body_of<QuaternionTrackingData>(*message), expected);

  const auto back = unpacked<igtl::QuaternionTrackingDataMessage>(ours(expected));
  ASSERT_EQ(back->GetNumberOfQuaternionTrackingDataElements(), 1);
  back->GetQuaternionTrackingDataElement(0, element);
  float position[3], quaternion[4];
  element->GetPosition(position);
  element->GetQuaternion(quaternion);
  EXPECT_EQ(position[0], 1.5f);
  EXPECT_EQ(quaternion[1], 0.6f);
  EXPECT_EQ(quaternion[3], 0.8f);
}

TEST(LinkLibrary, Position) {
  const auto message = igtl::PositionMessage::New();
  message->SetPosition(1, 2, 3.5f);
  message->SetQuaternion(0, 0.6f, 0, 0.8f);
  const link::Position expected{{1, 2, 3.5f}, {{0, 0.6f, 0, 0.8f}}};
  EXPECT_EQ(body_of<link::Position>(*message), expected);
  // The two shorter forms are tested by hand: packing them, the library writes behind its own buffer.

  const auto back = unpacked<igtl::PositionMessage>(ours(expected));
  float position[3], quaternion[4];
  back->GetPosition(position);
  back->GetQuaternion(quaternion);
  EXPECT_EQ(position[2], 3.5f);
  EXPECT_EQ(quaternion[1], 0.6f);
  EXPECT_EQ(quaternion[3], 0.8f);
}

TEST(LinkLibrary, Status) {
  const auto message = igtl::StatusMessage::New();
  message->SetCode(igtl::StatusMessage::STATUS_NOT_READY);
  message->SetSubCode(-7);
  message->SetErrorName("Warming");
  message->SetStatusString("wait a minute");
  const link::Status expected{13, -7, "Warming", "wait a minute"};
  EXPECT_EQ(body_of<link::Status>(*message), expected);

  const auto back = unpacked<igtl::StatusMessage>(ours(expected));
  EXPECT_EQ(back->GetCode(), 13);
  EXPECT_EQ(back->GetSubCode(), -7);
  EXPECT_STREQ(back->GetErrorName(), "Warming");
  EXPECT_STREQ(back->GetStatusString(), "wait a minute");
}

TEST(LinkLibrary, String) {
  const auto message = igtl::StringMessage::New();
  message->SetString("{\"force_N\":0.1}");
  EXPECT_EQ(body_of<link::String>(*message).text, "{\"force_N\":0.1}");

  const auto back = unpacked<igtl::StringMessage>(ours(link::String{"gr\xC3\xBC\xC3\x9F"}));
  EXPECT_STREQ(back->GetString(), "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(back->GetEncoding(), 106);
  EXPECT_EQ(unpacked<igtl::StringMessage>(ours(link::String{"plain"}))->GetEncoding(), 3);
}

TEST(LinkLibrary, Sensor) {
  const link::Sensor expected{0, kNewton, {0.1, -0.2, 1e-310, 1e300, 4e-3, 9e-3}};
  const auto message = igtl::SensorMessage::New();
  message->SetLength(6);
  message->SetUnit(kNewton);
  for (unsigned int i = 0; i < 6; ++i) message->SetValue(i, expected.values[i]);
  EXPECT_EQ(body_of<link::Sensor>(*message), expected);

  const auto back = unpacked<igtl::SensorMessage>(ours(expected));
  ASSERT_EQ(back->GetLength(), 6U);
  EXPECT_EQ(back->GetUnit(), kNewton);
  for (unsigned int i = 0; i < 6; ++i) EXPECT_EQ(back->GetValue(i), expected.values[i]);
}

/// With everything a POLYDATA may hold; we keep points and lines.
igtl::PolyDataMessage::Pointer full_mesh() {
  const auto message = igtl::PolyDataMessage::New();
  const auto points = igtl::PolyDataPointArray::New();
  for (const float x : {0.0f, 1.5f, 3.0f}) points->AddPoint(x, -x, 2 * x);
  message->SetPoints(points);
  const auto cells = [](std::initializer_list<std::list<igtlUint32>> all) {
    const auto array = igtl::PolyDataCellArray::New();
    for (const auto& cell : all) array->AddCell(cell);
    return array;
  };
  message->SetVertices(cells({{0}, {1}}));
  message->SetLines(cells({{0, 1, 2}, {2, 0}}));
  message->SetPolygons(cells({{0, 1, 2}}));
  message->SetTriangleStrips(cells({{2, 1, 0}}));
  for (const char* const name : {"odd", "even"}) {
    const auto attribute = igtl::PolyDataAttribute::New();
    attribute->SetType(igtl::PolyDataAttribute::POINT_VECTOR);
    attribute->SetSize(3);
    attribute->SetName(name);
    igtlFloat32 values[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    attribute->SetData(values);
    message->AddAttribute(attribute);
  }
  return message;
}

TEST(LinkLibrary, PolyData) {
  const link::PolyData expected{{{0, 0, 0}, {1.5f, -1.5f, 3}, {3, -3, 6}}, {{0, 1, 2}, {2, 0}}};
  EXPECT_EQ(body_of<link::PolyData>(*full_mesh()), expected);

  const auto back = unpacked<igtl::PolyDataMessage>(ours(expected));
  ASSERT_EQ(back->GetPoints()->GetNumberOfPoints(), 3);
  igtlFloat32 x = 0, y = 0, z = 0;
  back->GetPoints()->GetPoint(1, x, y, z);
  EXPECT_EQ(x, 1.5f);
  EXPECT_EQ(y, -1.5f);
  EXPECT_EQ(z, 3.0f);
  ASSERT_EQ(back->GetLines()->GetNumberOfCells(), 2U);
  std::list<igtlUint32> line;
  back->GetLines()->GetCell(0, line);
  EXPECT_EQ(line, (std::list<igtlUint32>{0, 1, 2}));
}

TEST(LinkLibrary, StartAndStopTracking) {
  const auto message = igtl::StartTrackingDataMessage::New();
  message->SetResolution(50);
  message->SetCoordinateName("CAMERA");
  EXPECT_EQ(body_of<StartTracking>(*message), (StartTracking{50, "CAMERA"}));
  EXPECT_EQ(body_of<StopTracking>(*igtl::StopTrackingDataMessage::New()), StopTracking{});
  const auto reply = igtl::RTSTrackingDataMessage::New();
  EXPECT_EQ(body_of<Skipped>(*reply).type, "RTS_TDATA");

  const auto back = unpacked<igtl::StartTrackingDataMessage>(ours(StartTracking{20, "PATIENT"}));
  EXPECT_EQ(back->GetResolution(), 20);
  EXPECT_STREQ(back->GetCoordinateName(), "PATIENT");
  EXPECT_STREQ(unpacked<igtl::StopTrackingDataMessage>(ours(StopTracking{}))->GetDeviceType(), "STP_TDATA");
}

TEST(LinkLibrary, Capability) {
  const auto message = igtl::CapabilityMessage::New();
  message->SetTypes({"TRANSFORM", "GET_CAPABIL"});
  EXPECT_EQ(body_of<link::Capability>(*message), (link::Capability{{"TRANSFORM", "GET_CAPABIL"}}));
  EXPECT_EQ(body_of<GetCapability>(*igtl::GetCapabilityMessage::New()), GetCapability{});

  const auto back = unpacked<igtl::CapabilityMessage>(ours(link::Capability{{"SENSOR", "TWELVE_BYTES"}}));
  EXPECT_EQ(back->GetTypes(), (std::vector<std::string>{"SENSOR", "TWELVE_BYTES"}));
}

}  // namespace
}  // namespace palpate::link::test
