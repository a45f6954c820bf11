#pragma once

/// Where tests find what lies in the sources or was built. In a file of their own, which CMake writes: a folder's name
/// in a test's own source would keep it out of its batch, and a compiler cache from knowing it in another clone.
namespace spinaltap::test {

extern const char* const kSourceFolder;   ///< of the repository
extern const char* const kProgramFolder;  ///< of the programs and examples that were built
extern const char* const kExamplePlugin;  ///< the device plug-in of apps/examples
/// Plug-ins that are wrong: without an entry, of another version, without some functions.
extern const char* const kPluginWithoutEntry;
extern const char* const kPluginOfOldVersion;
extern const char* const kPluginOfHalf;

}  // namespace spinaltap::test
