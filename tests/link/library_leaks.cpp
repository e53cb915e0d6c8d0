// SPDX-License-Identifier: Apache-2.0

/// Debian's libopenigtlink does not free all it allocates (CAPABILITY, POLYDATA); a leak checker asks here.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOpenIGTLink\n"; }
