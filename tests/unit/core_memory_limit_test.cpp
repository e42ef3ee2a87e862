#include "core/memory_limit.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace covtrace {
namespace {

constexpr size_t kMegabyte = size_t{1} << 20;

std::string refusal(size_t bytes) {
    try {
        const MemoryReservation room(bytes, "5x7 pixels");
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
        return e.what();
    }
    return {};
}

TEST(MemoryLimit, RefusesWhatIsMoreThanIsLeft) {
    const MemoryLimit limit(resident_bytes() + 200 * kMegabyte);
    EXPECT_EQ(refusal(100 * kMegabyte), "");
    const std::string message = refusal(300 * kMegabyte);
    EXPECT_TRUE(message.starts_with("5x7 pixels need 300M")) << message;
    EXPECT_NE(message.find("the limit of"), std::string::npos) << message;
}

TEST(MemoryLimit, ReservationsCountWhileTheyLive) {
    const MemoryLimit limit(resident_bytes() + 200 * kMegabyte);
    {
        MemoryReservation first(150 * kMegabyte, "a");
        EXPECT_NE(refusal(150 * kMegabyte), "");
        const MemoryReservation moved = std::move(first);
        EXPECT_NE(refusal(150 * kMegabyte), "");
    }
    EXPECT_EQ(refusal(150 * kMegabyte), "");
}

TEST(MemoryLimit, WithoutOneTheMachineIsTheLimit) {
    {
        const MemoryLimit limit(0);
        EXPECT_NE(refusal(2 * kMegabyte), "");
    }
    EXPECT_EQ(refusal(2 * kMegabyte), "");
    EXPECT_NE(refusal(size_t{1} << 60).find("the machine's"), std::string::npos);
}

}  // namespace
}  // namespace covtrace
