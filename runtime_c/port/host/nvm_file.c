#include "nvm_file.h"

FILE *nvm_file_open(const char *path)
{
    FILE *file = fopen(path, "r+b");

    if (file == NULL) {
        file = fopen(path, "w+b");
    }
    if (file != NULL) {
        (void)setvbuf(file, NULL, _IONBF, 0);
    }
    return file;
}

int nvm_file_read(FILE *file, uint32_t address, uint8_t *octet)
{
    if (fseek(file, (long)address, SEEK_SET) != 0) {
        return -1;
    }
    const int found = fgetc(file);
    if (found == EOF) {
        *octet = 0xFFu; /* behind the end nothing was ever written */
        return ferror(file);
    }
    *octet = (uint8_t)found;
    return 0;
}

int nvm_file_write(FILE *file, uint32_t address, uint8_t octet)
{
    if (fseek(file, (long)address, SEEK_SET) != 0) {
        return -1;
    }
    return (fputc(octet, file) == EOF) ? -1 : 0;
}
