/* Windows since 8 gives random bytes by ProcessPrng of bcryptprimitives.dll, which Debian's Wine does not have: here it
 * is, by the function that it does have. For runs by Wine alone. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID bytes, ULONG count);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count) {
    return SystemFunction036(bytes, (ULONG)count);
}
