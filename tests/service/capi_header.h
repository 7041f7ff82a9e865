/* What capi_header.c, which is C, gives to capi_header_test.cpp. */
#pragma once

#include <stddef.h>

#include "forewalk.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const size_t capi_sizes_in_c[];
extern const size_t capi_size_count;
int capi_walk_in_c(forewalk_frame_out* out);

#ifdef __cplusplus
}
#endif
