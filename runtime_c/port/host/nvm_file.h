/*
 * Non-volatile memory in a file: octet n of the memory is octet n of the file.
 */
#ifndef NVM_FILE_H
#define NVM_FILE_H

#include <stdint.h>
#include <stdio.h>

/* Open the file, or make an empty one. NULL where this fails; errno says why. */
FILE *nvm_file_open(const char *path);

/* Both return 0 on success. What is written survives the end of the program, however it ends. */
int nvm_file_read(FILE *file, uint32_t address, uint8_t *octet);
int nvm_file_write(FILE *file, uint32_t address, uint8_t octet);

#endif
