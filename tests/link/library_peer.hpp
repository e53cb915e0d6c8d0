// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <igtlMessageBase.h>
#include <igtlMessageHeader.h>
#include <igtl_header.h>

#include <cstring>
#include <span>
#include <stdexcept>
#include <tests/link/example_messages.hpp>

namespace palpate::link::test {

/// The bytes of a message of Debian's library (header version 1).
inline Bytes packed(igtl::MessageBase& message) {
  message.Pack();
  const auto* const first = static_cast<const std::byte*>(message.GetPackPointer());
  return {first, first + message.GetPackSize()};
}

/// Our bytes as a message of the library, its CRC checked there.
template <typename LibraryMessage>
typename LibraryMessage::Pointer unpacked(const Bytes& bytes) {
  const auto header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), bytes.data(), IGTL_HEADER_SIZE);
  header->Unpack();
  const auto message = LibraryMessage::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  std::memcpy(message->GetPackBodyPointer(), bytes.data() + IGTL_HEADER_SIZE, bytes.size() - IGTL_HEADER_SIZE);
  const int status = message->Unpack(1);
  if (bytes.size() > IGTL_HEADER_SIZE && (status & igtl::MessageHeader::UNPACK_BODY) == 0)
    throw std::runtime_error("the library refuses the body");
  return message;
}

}  // namespace palpate::link::test
