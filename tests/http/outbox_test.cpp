// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/http/outbox.hpp>

namespace palpate::http {
namespace {

Message message(std::string text, bool droppable) {
  return {std::make_shared<const std::string>(std::move(text)), false, droppable};
}

std::vector<std::string> emptied(Outbox& outbox) {
  std::vector<std::string> texts;
  while (!outbox.empty()) texts.push_back(*outbox.pop().bytes);
  return texts;
}

TEST(HttpOutbox, KeepsOrderAndTheNewestRows) {
  Outbox outbox;
  EXPECT_EQ(outbox.push(message("hello", false)), Outbox::Taken::kYes);
  for (int row = 1; row <= 4; ++row) EXPECT_EQ(outbox.push(message(std::to_string(row), true)), Outbox::Taken::kYes);
  EXPECT_EQ(outbox.push(message("event", false)), Outbox::Taken::kYes);
  EXPECT_EQ(outbox.push(message("5", true)), Outbox::Taken::kOneDropped);
  EXPECT_EQ(outbox.push(message("6", true)), Outbox::Taken::kOneDropped);
  EXPECT_EQ(emptied(outbox), (std::vector<std::string>{"hello", "3", "4", "event", "5", "6"}));
  EXPECT_EQ(outbox.push(message("7", true)), Outbox::Taken::kYes) << "what has left no longer counts";
}

TEST(HttpOutbox, OverflowsByBytes) {
  Outbox outbox;
  const std::string half(Server::kMostWaitingBytes / 2, 'x');
  EXPECT_EQ(outbox.push(message(half, false)), Outbox::Taken::kYes);
  EXPECT_EQ(outbox.push(message(half, false)), Outbox::Taken::kYes);
  EXPECT_EQ(outbox.push(message("r", true)), Outbox::Taken::kOneDropped) << "a row has to wait, it overflows nothing";
  EXPECT_EQ(outbox.push(message("x", false)), Outbox::Taken::kOverflow);
  outbox.pop();
  EXPECT_EQ(outbox.push(message("x", false)), Outbox::Taken::kYes);
}

}  // namespace
}  // namespace palpate::http
