/* What an FMI 2.0 unit says: its logger has as many arguments as its format asks for, which only C can take. */

#include <stdarg.h>
#include <stdio.h>

void bramah_mockup_said(void *environment, int status, const char *message);

void bramah_mockup_logger(void *environment, const char *name, int status, const char *category, const char *format, ...) {
    char message[2048];
    va_list arguments;
    (void)name;
    (void)category;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format ? format : "", arguments);
    va_end(arguments);
    bramah_mockup_said(environment, status, message);
}
