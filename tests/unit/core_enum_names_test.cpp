#include "core/enum_names.h"

#include <gtest/gtest.h>

namespace covtrace {

namespace {

enum class Shape { round, flat };
enum class Nameless { one };

}  // namespace

template <>
inline constexpr auto kEnumNames<Shape> = enum_names<Shape>({{Shape::round, "round"},
                                                             {Shape::flat, "flat"}});

namespace {

TEST(EnumNames, LeadToNamesAndBack) {
    EXPECT_EQ(name_of(Shape::flat), "flat");
    EXPECT_EQ(value_named<Shape>("round"), Shape::round);
    EXPECT_EQ(value_named<Shape>("rOund"), Shape::round);
    EXPECT_EQ(value_named<Shape>("rounds"), std::nullopt);
    EXPECT_EQ(value_named<Shape>("roun"), std::nullopt);
    EXPECT_EQ(value_named<Shape>(""), std::nullopt);
    static_assert(!NamedEnum<Nameless>);
}

TEST(EnumNames, AreListedInTheirOrder) {
    EXPECT_EQ(listed_names<Shape>("|"), "round|flat");
    EXPECT_EQ(listed_names<Shape>(", ", "'"), "'round', 'flat'");
}

}  // namespace

}  // namespace covtrace
