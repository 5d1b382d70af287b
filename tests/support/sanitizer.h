// Defines a macro for the sanitizer the test is built with, for gcc and clang.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define SKYQUILT_ADDRESS_SANITIZER 1
#elif defined(__SANITIZE_THREAD__)
#define SKYQUILT_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SKYQUILT_ADDRESS_SANITIZER 1
#elif __has_feature(thread_sanitizer)
#define SKYQUILT_THREAD_SANITIZER 1
#endif
#endif
