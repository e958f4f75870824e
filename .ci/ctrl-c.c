/* Windows: runs a program and presses Ctrl-C in its console after so many milliseconds.
 *
 *   ctrl-c MILLISECONDS PROGRAM [ARGUMENT...]
 *
 * Gives back the program's exit code, or 125 where it could not be run. Arguments are joined by spaces. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

/* What is pressed reaches all of the console: this program outlives it. */
static BOOL WINAPI stay(DWORD event) { return event == CTRL_C_EVENT; }

int main(int count, char **arguments) {
    char line[4096] = "";
    STARTUPINFOA start = {.cb = sizeof start};
    PROCESS_INFORMATION child;
    DWORD code = 125;
    if (count < 3) return 125;
    for (int i = 2; i < count; i++) {
        if (strlen(line) + strlen(arguments[i]) + 2 > sizeof line) return 125;
        if (i > 2) strcat(line, " ");
        strcat(line, arguments[i]);
    }
    if (!CreateProcessA(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &child)) {
        fprintf(stderr, "cannot run %s: error %lu\n", line, GetLastError());
        return 125;
    }
    SetConsoleCtrlHandler(stay, TRUE);
    Sleep((DWORD)atoi(arguments[1]));
    if (!GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0))
        fprintf(stderr, "cannot press Ctrl-C: error %lu\n", GetLastError());
    WaitForSingleObject(child.hProcess, INFINITE);
    GetExitCodeProcess(child.hProcess, &code);
    return (int)code;
}
