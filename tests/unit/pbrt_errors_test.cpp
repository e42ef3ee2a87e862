/// Errors of directives and structure; those of parameters, shapes and so on are tested beside
/// them.
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneErrors, NameFileLineAndColumn) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"  Foo", "test.pbrt:2:3: unknown directive \"Foo\""},
        {"AtributeBegin", "did you mean \"AttributeBegin\""},
        {"\"sphere\"", "test.pbrt:2:1: expected a directive, found \"sphere\""},
        {"42", "unknown directive \"42\""},
        {"]", "expected a directive"},
        {"WorldEnd",
         "\"WorldEnd\" belongs to pbrt-v3; this reader expects version 4: convert the scene with "
         "\"pbrt --upgrade"},
        {"SurfaceIntegrator \"path\"", "pbrt-v3"},
        {"WorldBegin", "a second WorldBegin"},
        {"Camera \"perspective\"", "Camera must stand before WorldBegin"},
        {"Shape", "test.pbrt:2:6: expected a type in quotes, found the end of the file"},
        {"Shape sphere", "test.pbrt:2:7: expected a type in quotes, found \"sphere\""},
        {"Translate 1 2", "test.pbrt:2:14: expected a number, found the end of the file"},
        {"Translate 1 2 x", "test.pbrt:2:15: expected a number, found \"x\""},
        {"Translate 1 2 nan", "is not a finite number"},
        {"Transform 1 0 0 0", "expected [ before the 16 numbers"},
        {"Transform [ 1 0 0 0 ]", "test.pbrt:2:21: expected a number, found \"]\""},
        {"Rotate 90 0 0 0", "test.pbrt:2:1: the axis of Rotate has no length"},
        {"LookAt 0 0 0 0 0 0 0 1 0", "test.pbrt:2:1: LookAt is degenerate"},
        {"LookAt 0 0 0 0 0 1 0 0 2", "LookAt is degenerate"},
        {"LookAt 0 0 0 0 0 1 0 0 0", "LookAt is degenerate"},
        {"ActiveTransform Sometimes", "test.pbrt:2:17: unknown active transform \"Sometimes\""},
        {"CoordinateSystem \"here\" CoordSysTransform \"hear\"",
         "coordinate system \"hear\" is not defined; did you mean \"here\"?"},
        {"AttributeBegin", "test.pbrt:2:1: AttributeBegin has no matching end"},
        {"ObjectBegin \"o\"", "test.pbrt:2:1: ObjectBegin has no matching end"},
        {"ObjectBegin \"o\" AttributeEnd",
         "ObjectEnd is expected, for the ObjectBegin at test.pbrt:2:1"},
        {"ObjectBegin \"o\" AttributeBegin ObjectEnd", "begins at test.pbrt:2:17 is still open"},
        {"ObjectEnd", "ObjectEnd without ObjectBegin"},
        {"ObjectBegin \"o\" ObjectBegin \"p\"", "inside of the object \"o\""},
        {"ObjectBegin \"o\" ObjectEnd ObjectBegin \"o\" ObjectEnd",
         "object \"o\" is already defined"},
        {"ObjectBegin \"o\" ObjectInstance \"o\"", "objects can't hold instances"},
        {"ObjectBegin \"tree\" ObjectEnd ObjectInstance \"tee\"",
         "object \"tee\" is not defined; did you mean \"tree\"?"},
        {"Attribute \"shade\" \"float x\" 1", "unknown attribute target \"shade\""},
        {"Include", "expected a quoted file name after Include"},
        {"Include \"none.pbrt\"", "test.pbrt:2:9: file \"none.pbrt\" not found"},
        {"Import \"none.pbrt\"", "not found"},
        {"NamedMaterial \"\"", "empty name"},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(world_error(c.text), c.message)) << c.text;
}

TEST(SceneErrors, BlocksStandInTheWorld) {
    for (const char* text :
         {"AttributeBegin", "Shape \"sphere\"", "LightSource \"point\"", "Material \"diffuse\"",
          "Texture \"t\" \"float\" \"constant\"", "ObjectBegin \"o\"", "ReverseOrientation"})
        EXPECT_TRUE(contains(options_error(text), "must stand after WorldBegin")) << text;
}

TEST(SceneErrors, AWorldIsNeeded) {
    const Failure f = failure_of([] { read_pbrt_string("Film \"rgb\"\n", "t.pbrt"); });
    EXPECT_EQ(f.message, "t.pbrt:2:1: the scene ends before WorldBegin");
    EXPECT_EQ(failure_of([] { read_pbrt_string("", "t.pbrt"); }).kind, ErrorKind::scene);
}

TEST(SceneErrors, AnUnmatchedEndIsOnlyAWarning) {
    EXPECT_EQ(warnings_of(read_world("AttributeEnd\nTransformEnd\n")),
              "2: AttributeEnd without AttributeBegin; ignored (and in 1 more place)\n");
}

TEST(SceneErrors, MissingAndUnreadableFilesAreNamed) {
    const TemporaryFolder folder;
    const Failure missing = failure_of([&] { read_pbrt(folder.path() / "none.pbrt"); });
    EXPECT_EQ(missing.kind, ErrorKind::scene);
    EXPECT_TRUE(contains(missing.message, "none.pbrt\" not found"));
    const Failure directory = failure_of([&] { read_pbrt(folder.path()); });
    EXPECT_EQ(directory.kind, ErrorKind::scene);
    const auto image =
        folder.write("image.exr", std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8));
    EXPECT_EQ(failure_of([&] { read_pbrt(image); }).kind, ErrorKind::scene);
}

}  // namespace
}  // namespace covtrace::test
