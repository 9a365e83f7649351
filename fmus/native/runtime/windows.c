/* What on Windows no system library has, so that a instance needs nothing else: the C library itself is part of the
   system (ucrtbase.dll), and is ready without any start-up code. */
#ifdef _WIN32

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* C's own behaviour of snprintf: the length that was needed, and always an end. */
#define STANDARD 2

int __stdio_common_vsprintf(uint64_t options, char *text, size_t size, const char *format, void *locale, va_list values);

int vsnprintf(char *text, size_t size, const char *format, va_list values)
{
    return __stdio_common_vsprintf(STANDARD, text, size, format, NULL, values);
}

int snprintf(char *text, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int length = vsnprintf(text, size, format, values);
    va_end(values);
    return length;
}

int __fpclassify(double value)
{
    return __builtin_fpclassify(FP_NAN, FP_INFINITE, FP_NORMAL, FP_SUBNORMAL, FP_ZERO, value);
}

/* LLVM makes one call of two of the same angle; here they are two again, which it must not see through. */
__attribute__((no_builtin("sin", "cos"))) void sincos(double angle, double *sine, double *cosine)
{
    *sine = sin(angle);
    *cosine = cos(angle);
}

/* A stack grows by touching one page (4096 bytes) after the other. Functions with more than a page of variables
   call this first, with their size in rax; all registers stay as they are. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    pushq %rcx\n"
        "    pushq %rax\n"
        "    leaq 24(%rsp), %rcx\n"
        "    jmp 2f\n"
        "1:  subq $4096, %rcx\n"
        "    testq %rcx, (%rcx)\n"
        "    subq $4096, %rax\n"
        "2:  cmpq $4096, %rax\n"
        "    ja 1b\n"
        "    subq %rax, %rcx\n"
        "    testq %rcx, (%rcx)\n"
        "    popq %rax\n"
        "    popq %rcx\n"
        "    ret\n");

#endif
