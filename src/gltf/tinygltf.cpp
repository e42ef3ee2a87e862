/// The library's own code, compiled once.
#include <fstream>  // the library needs it even where it reads no files itself

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
