/// The implementation of the library tinygltf, which is all in its header, compiled once.
#include <fstream>  // the library needs it even where it reads no files itself

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
