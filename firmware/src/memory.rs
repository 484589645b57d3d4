//! Copying and filling memory, as the compiler calls for it: small instead of fast.
//!
//! The compiler's own library unrolls these for long, aligned blocks, in 3.2 KB. Here they move structs of some hundred
//! bytes a tick, and a word every four instructions is enough: 0.1 KB. Words may lie at any address: a Cortex-M4 or M7
//! loads and stores them wherever memory is ordinary, and nothing here turns that off.
//!
//! `memcpy` is `memmove`. Copying upwards is right while the destination does not start inside the source, whatever their
//! distance: each word is loaded before any store can reach it.
//!
//! `.ci/emulated memory` holds them to the definition, for every length, offset and overlap that differs.

use core::arch::global_asm;

global_asm!(
    ".syntax unified",
    ".thumb",
    ".section .text.memmove, \"ax\", %progbits",
    ".global memcpy, memmove",
    ".global __aeabi_memcpy, __aeabi_memcpy4, __aeabi_memcpy8",
    ".global __aeabi_memmove, __aeabi_memmove4, __aeabi_memmove8",
    ".thumb_func",
    "memcpy:",
    ".thumb_func",
    "memmove:",
    ".thumb_func",
    "__aeabi_memcpy:",
    ".thumb_func",
    "__aeabi_memcpy4:",
    ".thumb_func",
    "__aeabi_memcpy8:",
    ".thumb_func",
    "__aeabi_memmove:",
    ".thumb_func",
    "__aeabi_memmove4:",
    ".thumb_func",
    "__aeabi_memmove8:",
    // r0: destination, returned as it is; r1: source; r2: bytes.
    "subs r3, r0, r1",
    "cmp r3, r2",
    "blo 5f", // the destination starts inside the source
    "mov r12, r0",
    "b 2f",
    "1: ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "2: subs r2, #4",
    "bhs 1b",
    "adds r2, #4",
    "b 4f",
    "3: ldrb r3, [r1], #1",
    "strb r3, [r12], #1",
    "4: subs r2, #1",
    "bhs 3b",
    "bx lr",
    "5: b 7f",
    "6: ldrb r3, [r1, r2]",
    "strb r3, [r0, r2]",
    "7: subs r2, #1",
    "bhs 6b",
    "bx lr",
    ".size memmove, . - memmove",
    ".section .text.memset, \"ax\", %progbits",
    ".global memset",
    ".global __aeabi_memset, __aeabi_memset4, __aeabi_memset8",
    ".global __aeabi_memclr, __aeabi_memclr4, __aeabi_memclr8",
    ".thumb_func",
    "__aeabi_memclr:",
    ".thumb_func",
    "__aeabi_memclr4:",
    ".thumb_func",
    "__aeabi_memclr8:",
    // r0: destination; r1: bytes.
    "movs r2, #0",
    ".thumb_func",
    "__aeabi_memset:",
    ".thumb_func",
    "__aeabi_memset4:",
    ".thumb_func",
    "__aeabi_memset8:",
    // r0: destination; r1: bytes; r2: what to fill them with. The other way round from memset's.
    "mov r3, r1",
    "mov r1, r2",
    "mov r2, r3",
    ".thumb_func",
    "memset:",
    // r0: destination, returned as it is; r1: what to fill it with; r2: bytes.
    "uxtb r1, r1",
    "orr r1, r1, r1, lsl #8",
    "orr r1, r1, r1, lsl #16",
    "mov r12, r0",
    "b 9f",
    "8: str r1, [r12], #4",
    "9: subs r2, #4",
    "bhs 8b",
    "adds r2, #4",
    "b 11f",
    "10: strb r1, [r12], #1",
    "11: subs r2, #1",
    "bhs 10b",
    "bx lr",
    ".size __aeabi_memclr, . - __aeabi_memclr",
);
